#pragma once
// The lines that the pictures of gloves and of trackers in a terminal have in common.

#include <optional>
#include <string>

#include <nendo/driver/stream_stats.hpp>

namespace nendo::gloves {

/// Returns the number with so many decimals.
std::string fixed(double value, int decimals);
/// Returns the text with blanks before it, `width` characters or more.
std::string right_aligned(const std::string& text, int width);
/// Returns the text, or its beginning with a '~' as the last of `width` characters.
std::string cut(std::string text, int width);
/// Puts `right` at the end of the line, and cuts `left` for it, unless hardly anything would be
/// left.
std::string both_ends(const std::string& left, const std::string& right, int width);

/// What a line about a device's stream says.
struct StreamState {
  driver::StreamStats stats;
  double asked_hz = 0.0;         ///< the nominal rate; 0: unknown
  std::optional<double> age_s{}; ///< the latest sample's age; nothing: none came yet
  const char* none_yet = "no sample yet";
};

/// Returns the rate, the age of the latest sample, and the losses: "90.0/s, 8 ms old, 359
/// delivered, nothing lost".
std::string stream_text(const StreamState& state);
/// Returns the same for one line, with `keys` at the end if they fit.
std::string stream_line(const StreamState& state, const std::string& keys, int width);

} // namespace nendo::gloves
