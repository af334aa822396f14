#pragma once
// The options of nendo stress, and the check of its arguments.

#include <optional>
#include <string>
#include <vector>

#include "session/loop_options.hpp"
#include "session/run_options.hpp"
#include "stress/conditions.hpp"

namespace nendo::stress {

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
  double changes_a_minute = 0.0;
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
  double changes_a_minute = 0.0; ///< of settings, in every other second
};

/// Checks the arguments. Error: usage, naming the option.
Result<StressOptions> parse(const StressArguments& arguments);

/// Parses a list of stages, such as "sleep,input,hands". Sleep is always a stage. Error: usage.
Result<flow::TickStages> parse_stages(const std::string& text);

} // namespace nendo::stress
