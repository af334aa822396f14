#pragma once
// Reading the small text files of /sys, /proc and /run. All of them may vanish at any time, and
// some repeat what a device says of itself.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nendo::driver {

/// Returns the text as a terminal may show it: what is not printable ASCII became '?', and it is
/// cut at 128 characters.
std::string printable(std::string_view text);

/// Returns the first line, printable; an empty text if the file cannot be read.
std::string read_line(const std::filesystem::path& path);
/// Returns the file, at most 1 MiB of it; an empty text if it cannot be read.
std::string read_text(const std::filesystem::path& path);
/// Returns the number that the text is, and nothing else; nullopt if it is none.
std::optional<unsigned> parse_number(std::string_view text, int base = 10);
/// Returns the number that the file holds; nullopt if there is none.
std::optional<unsigned> read_number(const std::filesystem::path& path, int base = 10);

/// Returns the names of the entries, 65536 at most; none if the folder cannot be read.
std::vector<std::string> names_in(const std::filesystem::path& folder);

} // namespace nendo::driver
