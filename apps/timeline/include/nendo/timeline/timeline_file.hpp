#pragma once
// Timelines as text: TOML that people can read, compare and edit. Files end in .timeline.toml.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/timeline/timeline.hpp>

namespace nendo::timeline {

inline constexpr std::string_view file_ending = ".timeline.toml";
inline constexpr std::uint64_t most_file_bytes = std::uint64_t{1} << 26;

/// The same timeline gives the same text, and the text reads back to the same bits. Error: failed
/// (a complaint_about(), a file name that is no UTF-8, too many keys for a file).
Result<std::string> timeline_text(const Timeline& timeline);
/// `name` begins every error. Error: bad_input, with the line: no TOML, another version, names that
/// are unknown or missing, a complaint_about().
Result<Timeline> parse_timeline(std::string_view text, std::string_view name);

/// Error: bad_input, as parse_timeline() and read_file(). Blocks.
Result<Timeline> read_timeline(const std::filesystem::path& path);
/// Atomically, over what is there (replace_file()). Error: failed. Blocks.
Result<void> write_timeline(const std::filesystem::path& path, const Timeline& timeline);
/// By the name's ending alone.
bool is_timeline(const std::filesystem::path& path);

} // namespace nendo::timeline
