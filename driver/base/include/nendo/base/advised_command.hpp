#pragma once
// Commands that messages advise the user to run.

#include <filesystem>
#include <string>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo {

/// Quotes `text` as one shell word. Text without shell metacharacters is returned unchanged. A
/// glove specification with ? or & needs the quotes.
NENDO_API std::string shell_word(std::string_view text);

/// Returns the command that runs nendo with these arguments as root, e.g. "sudo nendo udev
/// install". It contains this program's full path if this is a nendo outside of sudo's search path.
NENDO_API std::string as_root(std::string_view arguments);
/// The same for the program at the path `program`.
NENDO_API std::string as_root(std::string_view arguments, const std::filesystem::path& program);

} // namespace nendo
