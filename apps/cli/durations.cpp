#include "cli/durations.hpp"

#include <array>
#include <charconv>
#include <string_view>

namespace nendo::cli {

Result<double> parse_duration(const std::string& text, const std::string& option) {
  struct Unit {
    std::string_view name;
    double seconds;
  };
  constexpr std::array<Unit, 5> units{
      {{"", 1.0}, {"s", 1.0}, {"m", 60.0}, {"h", 3600.0}, {"d", 86'400.0}}};
  constexpr double most_s = 1e7;
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  const std::string_view suffix(stopped, static_cast<std::size_t>(end - stopped));
  for (const Unit& unit : units) {
    const double seconds = value * unit.seconds;
    if (error == std::errc{} && suffix == unit.name && seconds > 0.0 && seconds <= most_s)
      return seconds;
  }
  return Error{Errc::usage, option + " " + text + ": use seconds above 0, or 10m, 2h, 1d"};
}

} // namespace nendo::cli
