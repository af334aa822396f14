#pragma once
// The conditions of --fail-if: thresholds for the figures of a report.

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <nendo/base/result.hpp>

namespace nendo::stress {

/// A condition such as "p99.9>200us": a figure of the report's JSON, and what it must not be.
struct Condition {
  std::string text;              ///< as written
  std::vector<std::string> path; ///< in the report, "lateness_us" and "p99_9"
  char relation = '>';           ///< '<' or '>'
  bool or_equal = false;
  double threshold = 0.0; ///< in the figure's own unit: microseconds, or a count
};

/// Parses conditions that are separated by commas. A condition is [corrected.][MEASURE.]FIGURE,
/// then > >= < or <=, then a number with ns, us, ms or s (us without a unit). MEASURE is lateness
/// (the default), period_error, work, input_age or end_to_end. FIGURE is min, p50, p90, p99, p99.9,
/// p99.99 or max; or a count: ticks, missed, overruns, faults or switches; or longest_outage.
/// Error: usage.
Result<std::vector<Condition>> parse_conditions(const std::string& text);

/// Returns the conditions that the report fulfils, each with its figure: "p99.9>200us (312.4 us)".
/// A figure that was not measured, for want of samples for example, fulfils its condition, so
/// that it is reported.
std::vector<std::string> fulfilled(const std::vector<Condition>& conditions,
                                   const nlohmann::ordered_json& report);

} // namespace nendo::stress
