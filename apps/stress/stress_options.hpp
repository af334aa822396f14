#pragma once
// The options of nendo stress, the check of its arguments, and the conditions of --fail-if.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <nendo/base/result.hpp>

#include "session/run_options.hpp"
#include "session/setting_options.hpp"

namespace nendo::stress {

/// A condition such as "p99.9>200us": a figure of the report's JSON, and what it must not be.
struct Condition {
  std::string text; ///< as written
  std::string path; ///< in the report, "/lateness_us/p99_9"
  bool is_count = false;
  char relation = '>'; ///< '<' or '>'
  bool or_equal = false;
  double threshold = 0.0; ///< in the figure's own unit: microseconds, or a count
};

/// The figures of a histogram in the report.
inline constexpr std::array<std::string_view, 7> figure_names{"min",   "p50",    "p90", "p99",
                                                              "p99_9", "p99_99", "max"};

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

/// The arguments as they were typed.
struct StressArguments {
  double interval_us = 1000.0;
  std::string duration = "10";
  std::string stages = "sleep,input,hands,deform,publish";
  std::string mode = "type1";
  std::string up; ///< the axis that is up in the model's file; empty: y
  std::string radius;
  std::string load;
  std::string fail_if;
  std::optional<double> break_us;
  std::optional<unsigned> histogram_us;
  double floor_s = 1.0;
  double changes_per_minute = 0.0;
  std::string hgrm;
  std::string picture;
  std::string compare;
  bool view = false;
  bool json = false;
  session::LoopArguments loop{.priority = flow::usual_priority};
  session::RunOptions run;
};

/// The meaning of the arguments. `run` is complete: it has gloves, model, loop and rights.
struct StressOptions {
  session::RunOptions run;
  std::vector<std::string> load;
  std::vector<Condition> conditions;
  std::optional<std::chrono::nanoseconds> break_at; ///< ends at a tick that is later than that
  double floor_s = 0.0;
  double changes_per_minute = 0.0; ///< changes of settings in every other second
};

/// Checks the arguments. Error: usage, naming the option.
Result<StressOptions> parse(const StressArguments& arguments);

/// Parses a list of stages, such as "sleep,input,hands". Sleep is always a stage. Error: usage.
Result<flow::TickStages> parse_stages(const std::string& text);
/// Returns the names of the stages, with "sleep" first.
std::vector<std::string> stage_names(const flow::TickStages& stages);

} // namespace nendo::stress
