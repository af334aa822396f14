#pragma once
// Reads the small text files of /sys, /proc and /run. All of them may vanish at any time, and some
// have strings of a device.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nendo::driver {

/// Returns at most 128 characters of the text; those that are not printable ASCII become '?'.
std::string printable(std::string_view text);

/// Returns the first line, printable; an empty string if the file cannot be read.
std::string read_line(const std::filesystem::path& path);
/// Returns the file, at most 1 MiB of it; an empty string if it cannot be read.
std::string read_text(const std::filesystem::path& path);
/// Returns the number in the file's first line; nullopt if there is none.
std::optional<unsigned> read_number(const std::filesystem::path& path, int base = 10);

/// Returns the names of the entries, 65536 at most; none if the folder cannot be read.
std::vector<std::string> names_in(const std::filesystem::path& folder);

} // namespace nendo::driver
