#include "stress/report_parts.hpp"

#include <chrono>
#include <cstdio>
#include <ctime>

namespace nendo::stress {

std::optional<Figures> figures_of(const flow::Histogram& histogram) {
  if (histogram.count() == 0) return std::nullopt;
  const auto at = [&](double fraction) { return to_microseconds(histogram.percentile(fraction)); };
  return Figures{histogram.count(),
                 {to_microseconds(histogram.min()), at(0.50), at(0.90), at(0.99), at(0.999),
                  at(0.9999), to_microseconds(histogram.max())}};
}

std::vector<std::string> stage_names(const flow::TickStages& stages) {
  std::vector<std::string> names{"sleep"};
  if (stages.input) names.emplace_back("input");
  if (stages.hands) names.emplace_back("hands");
  if (stages.deform) names.emplace_back("deform");
  if (stages.publish) names.emplace_back("publish");
  return names;
}

std::string wall_time(const StressOutcome& outcome, HostTime time) {
  const auto wall = outcome.wall_start +
                    std::chrono::duration_cast<std::chrono::nanoseconds>(time - outcome.start);
  const auto second = std::chrono::floor<std::chrono::seconds>(wall);
  const std::time_t at = std::chrono::system_clock::to_time_t(second);
  std::tm utc{};
  gmtime_r(&at, &utc);
  char text[64];
  const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(text + length, sizeof text - length, ".%06lldZ",
                static_cast<long long>(
                    std::chrono::duration_cast<std::chrono::microseconds>(wall - second).count()));
  return text;
}

} // namespace nendo::stress
