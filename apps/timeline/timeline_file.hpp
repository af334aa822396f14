#pragma once
// Timelines as TOML text, which people can read, compare and edit. File names end in
// .timeline.toml.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

inline constexpr std::string_view file_ending = ".timeline.toml";
inline constexpr std::uint64_t max_file_bytes = std::uint64_t{1} << 26;

// Keys that are always true: a timeline without them was made by an unreleased program, whose rules
// were others.
inline constexpr std::string_view pull_rule = "pull_is_step";
constexpr std::string_view rule_of_sculptor(bool is_puppet) noexcept {
  return is_puppet ? "type2_along_surface" : "clay_scales_few_vertices";
}

/// Returns the timeline as text. The same timeline always gives the same text, and reading the text
/// gives the same bits. Error: failed (complaint_about() has a complaint, a file name is not UTF-8,
/// or there are too many keys for a file).
Result<std::string> timeline_text(const Timeline& timeline);
/// Parses the text of a timeline. Error: bad_input (not TOML, another version, unknown or missing
/// names, or complaint_about() has a complaint). The message begins with `name` and the line.
Result<Timeline> parse_timeline(std::string_view text, std::string_view name);

/// Reads a timeline. Errors: those of parse_timeline() and read_file(). Blocks.
Result<Timeline> read_timeline(const std::filesystem::path& path);
/// Writes the file atomically and replaces an existing one. Error: failed. Blocks.
Result<void> write_timeline(const std::filesystem::path& path, const Timeline& timeline);
/// Returns whether a file is a timeline, by the ending of its name only.
bool is_timeline(const std::filesystem::path& path);

} // namespace nendo::timeline
