#pragma once
// The figures of a stress report, of which its text and its JSON are made.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stress/stress_session.hpp"

namespace nendo::stress {

/// How a histogram is reported. Times are in microseconds.
struct Figures {
  static constexpr std::array<std::string_view, 7> names{"min",   "p50",    "p90", "p99",
                                                         "p99_9", "p99_99", "max"};
  std::uint64_t count = 0;
  std::array<double, names.size()> us{}; ///< in the order of `names`
};

/// Returns nothing if nothing was recorded.
std::optional<Figures> figures_of(const flow::Histogram& histogram);

/// Returns the names of the stages that a tick runs, with "sleep" first.
std::vector<std::string> stage_names(const flow::TickStages& stages);

/// Returns a time of the run as ISO 8601 in UTC, with microseconds.
std::string wall_time(const StressOutcome& outcome, HostTime time);

} // namespace nendo::stress
