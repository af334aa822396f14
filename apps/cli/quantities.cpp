#include "cli/quantities.hpp"

#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <system_error>

namespace nendo::cli {
namespace {

constexpr double max_s = 1e7; // longer than any recording

struct Unit {
  std::string_view name;
  double size;
};

// Not strtod, whose decimal point is a matter of the locale.
std::optional<double> in_units(std::string_view text, std::initializer_list<Unit> units) noexcept {
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{}) return std::nullopt;
  const std::string_view suffix(stopped, static_cast<std::size_t>(end - stopped));
  for (const Unit& unit : units)
    if (suffix == unit.name && std::isfinite(number * unit.size)) return number * unit.size;
  return std::nullopt;
}

} // namespace

std::optional<double> seconds_of(std::string_view text) noexcept {
  return in_units(
      text, {{"", 1.0}, {"ms", 1e-3}, {"s", 1.0}, {"m", 60.0}, {"h", 3600.0}, {"d", 86'400.0}});
}

std::optional<double> microseconds_of(std::string_view text) noexcept {
  return in_units(text, {{"", 1.0}, {"us", 1.0}, {"ms", 1e3}, {"s", 1e6}});
}

std::optional<double> hertz_of(std::string_view text) noexcept {
  return in_units(text, {{"", 1.0}, {"Hz", 1.0}, {"kHz", 1e3}});
}

std::optional<double> number_of(std::string_view text) noexcept {
  return in_units(text, {{"", 1.0}});
}

Result<void> check_duration(double seconds, End end) {
  const bool may_be_missing = end == End::may_be_missing;
  if (seconds >= 0.0 && seconds <= max_s && (seconds > 0.0 || may_be_missing)) return {};
  return Error{Errc::usage, "--duration: use " + std::string(duration_words) + ", " +
                                (may_be_missing ? "up to 10000000 s, or 0 for no end"
                                                : "above 0, up to 10000000 s: it must end")};
}

Result<double> parse_duration(const std::string& text, const std::string& option) {
  const auto seconds = seconds_of(text);
  if (seconds && *seconds > 0.0 && *seconds <= max_s) return *seconds;
  return Error{Errc::usage,
               option + " " + text + ": use " + std::string(duration_words) + ", above 0"};
}

Result<TimeSpan> parse_time_span(const std::string& text, const std::string& option,
                                 SpanEnds ends) {
  const bool may_be_open = ends == SpanEnds::may_be_open;
  const auto time = [&](std::string_view part, double open) -> std::optional<double> {
    if (part.empty() && may_be_open) return open;
    const auto seconds = seconds_of(part);
    return seconds && *seconds >= 0.0 && *seconds <= max_s ? seconds : std::nullopt;
  };
  const auto colon = text.find(':');
  std::optional<double> from, to;
  if (colon != std::string::npos) {
    from = time(std::string_view(text).substr(0, colon), 0.0);
    to = time(std::string_view(text).substr(colon + 1), std::numeric_limits<double>::infinity());
  }
  if (!from || !to)
    return Error{Errc::usage, option + " " + text +
                                  ": use two times with a colon between, such as " +
                                  (may_be_open ? "2s:5.5s, 2s: or :5s" : "0.8s:2.5s")};
  if (*to <= *from) return Error{Errc::usage, option + " " + text + ": ends before it begins"};
  return TimeSpan{*from, *to};
}

} // namespace nendo::cli
