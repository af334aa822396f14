#pragma once
// Reading the small text files of /sys, /proc and /run. All of them may vanish at any time, and
// some repeat what a device says of itself.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nendo::driver {

/// The text with whatever is not printable ASCII replaced by '?', cut at 128 characters: it goes to
/// a terminal.
std::string printable(std::string_view text);

/// The first line, printable; empty if the file cannot be read.
std::string read_line(const std::filesystem::path& path);
/// At most 1 MiB of it; empty if it cannot be read.
std::string read_text(const std::filesystem::path& path);
/// The number that the file holds and nothing else; nullopt if there is none.
std::optional<unsigned> read_number(const std::filesystem::path& path, int base = 10);

/// The entries' names, 65536 at most; empty if the folder cannot be read.
std::vector<std::string> names_in(const std::filesystem::path& folder);

/// Where a link of /sys leads, without asking the file system about anything behind it; nullopt if
/// it is no link.
std::optional<std::filesystem::path> link_target(const std::filesystem::path& link);

} // namespace nendo::driver
