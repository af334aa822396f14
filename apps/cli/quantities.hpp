#pragma once
// Durations and rates as people type them, a number and mostly a unit, and the words of messages
// about these and lengths. nendo::to_metres() reads lengths.

#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::cli {

/// What may be typed for a duration and for a length, for error messages.
inline constexpr std::string_view duration_words = "seconds, or 500ms, 90s, 10m, 2h, 1d";
inline constexpr std::string_view length_words = "a length like 1mm, 0.5cm or 0.2m";

/// Returns the seconds of "90", "90s", "500ms", "10m", "2h" or "1d". A bare number is seconds, and
/// any finite number will do, 0 and negative ones too. Nothing if the text is no duration.
std::optional<double> seconds_of(std::string_view text) noexcept;

/// Returns the microseconds of "250", "250us", "1ms" or "0.1s", and the hertz of "90", "90Hz" or
/// "1kHz". Nothing if the text is neither.
std::optional<double> microseconds_of(std::string_view text) noexcept;
std::optional<double> hertz_of(std::string_view text) noexcept;

/// Returns the number that is all of the text, if it is finite.
std::optional<double> number_of(std::string_view text) noexcept;

enum class End : bool { needed, may_be_missing };
/// Checks a --duration: 0 is without an end, in all commands that may have none; otherwise at most
/// 10000000 s. Error: usage.
Result<void> check_duration(double seconds, End end = End::may_be_missing);
/// Returns the seconds of a duration that must be more than 0 and at most 10000000 s. Error: usage,
/// naming the option.
Result<double> parse_duration(const std::string& text, const std::string& option = "--duration");

/// Two times, s. Where it is open, `from_s` is 0, and `to_s` infinite.
struct TimeSpan {
  double from_s = 0.0;
  double to_s = 0.0;
};
enum class SpanEnds : bool { both, may_be_open };
/// Reads two times with a colon between, up to 10000000 s; the second is later. One that may be
/// open needs neither. Error: usage, naming the option.
Result<TimeSpan> parse_time_span(const std::string& text, const std::string& option, SpanEnds ends);

} // namespace nendo::cli
