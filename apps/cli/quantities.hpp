#pragma once
// Parses durations and rates, numbers with an optional unit, and has strings for messages about
// these and lengths. nendo::to_metres() parses lengths.

#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::cli {

/// The valid forms of a duration and of a length, for error messages.
inline constexpr std::string_view duration_words = "seconds, or 500ms, 90s, 10m, 2h, 1d";
inline constexpr std::string_view length_words = "a length like 1mm, 0.5cm or 0.2m";

/// Returns the seconds of "90", "90s", "500ms", "10m", "2h" or "1d". A bare number is in seconds.
/// Accepts any finite number, also 0 and negative ones. Nothing if the text is invalid.
std::optional<double> seconds_of(std::string_view text) noexcept;

/// Returns the microseconds of "250", "250us", "1ms" or "0.1s", and the hertz of "90", "90Hz" or
/// "1kHz". Nothing if the text is invalid.
std::optional<double> microseconds_of(std::string_view text) noexcept;
std::optional<double> hertz_of(std::string_view text) noexcept;

/// Parses the whole text as a finite number.
std::optional<double> number_of(std::string_view text) noexcept;

enum class End : bool { needed, may_be_missing };
/// Checks a --duration: at most 10000000 s; 0 means no end, with End::may_be_missing. Error: usage.
Result<void> check_duration(double seconds, End end = End::may_be_missing);
/// Returns the seconds of a duration that must be more than 0 and at most 10000000 s. Error: usage,
/// naming the option.
Result<double> parse_duration(const std::string& text, const std::string& option = "--duration");

/// Two times. At an open end, `from_s` is 0, and `to_s` infinite.
struct TimeSpan {
  double from_s = 0.0;
  double to_s = 0.0;
};
enum class SpanEnds : bool { both, may_be_open };
/// Parses FROM:TO, up to 10000000 s, with TO after FROM. With SpanEnds::may_be_open, both can be
/// omitted. Error: usage, naming the option.
Result<TimeSpan> parse_time_span(const std::string& text, const std::string& option, SpanEnds ends);

} // namespace nendo::cli
