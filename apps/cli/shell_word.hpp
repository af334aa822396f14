#pragma once
// Words of a command that a message tells somebody to type.

#include <string>
#include <string_view>

namespace nendo::cli {

/// Returns the text as one word of a shell's command line: as it is if no shell does anything with
/// it, else in single quotes. A GLOVE with ? or & needs them.
std::string shell_word(std::string_view text);

} // namespace nendo::cli
