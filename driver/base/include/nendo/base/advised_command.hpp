#pragma once
// Commands in messages, for the user to type.

#include <filesystem>
#include <string>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo {

/// Returns the text as one word of a shell's command line: as it is if no shell does anything with
/// it, else in single quotes. A GLOVE with ? or & needs them.
NENDO_API std::string shell_word(std::string_view text);

/// Returns the command that runs nendo with these arguments as root: "sudo nendo udev install". If
/// this program is a nendo in a folder in which sudo does not look for programs, the command has
/// its whole path.
NENDO_API std::string as_root(std::string_view arguments);
/// The same for a program with that path.
NENDO_API std::string as_root(std::string_view arguments, const std::filesystem::path& program);

} // namespace nendo
