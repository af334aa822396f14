#include "stress/stress_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "cli/cli.hpp"
#include "cli/quantities.hpp"
#include "session/place_loop.hpp"
#include "stress/load.hpp"

namespace nendo::stress {
namespace {

using flow::TickStages;
constexpr std::array stages_by_name{std::pair{std::string_view("input"), &TickStages::input},
                                    std::pair{std::string_view("hands"), &TickStages::hands},
                                    std::pair{std::string_view("deform"), &TickStages::deform},
                                    std::pair{std::string_view("publish"), &TickStages::publish}};

Error usage(std::string message) {
  return {Errc::usage, std::move(message)};
}

Result<void> parse_loop(const StressArguments& arguments, session::RunOptions& run) {
  constexpr double min_us = 1e6 / flow::TickGrid::max_rate_hz;
  constexpr double max_us = 1e6 / flow::TickGrid::min_rate_hz;
  if (!(arguments.interval_us >= min_us && arguments.interval_us <= max_us))
    return usage("--interval: use 100us to 1s");
  run.loop.rate_hz = 1e6 / arguments.interval_us;
  const auto mode = session::parse_setting(flow::setting::mode, arguments.mode);
  if (!mode) return mode.error();
  run.loop.sculptor.mode = *mode;
  const auto stages = parse_stages(arguments.stages);
  if (!stages) return stages.error();
  run.loop.stages = *stages;
  if (const auto fine = arguments.loop.parse(run.loop, run.realtime); !fine) return fine.error();
  if (run.loop.policy == flow::OverrunPolicy::sample && !stages->input)
    return usage("--policy sample: needs the stage input, because it waits for samples");
  run.radius = arguments.radius;
  if (const auto supports = session::parse_radius(run.radius, 1.0); !supports)
    return supports.error();
  return {};
}

} // namespace

Result<flow::TickStages> parse_stages(const std::string& text) {
  flow::TickStages stages{false, false, false, false};
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    const std::string_view name = rest.substr(0, comma);
    const auto* const stage = std::find_if(stages_by_name.begin(), stages_by_name.end(),
                                           [&](const auto& known) { return known.first == name; });
    if (stage != stages_by_name.end())
      stages.*stage->second = true;
    else if (name != "sleep")
      return usage("--stages " + text + ": use sleep, input, hands, deform, publish with commas");
    if (comma == std::string_view::npos) return stages;
    rest.remove_prefix(comma + 1);
  }
}

std::vector<std::string> stage_names(const flow::TickStages& stages) {
  std::vector<std::string> names{"sleep"};
  for (const auto& [name, stage] : stages_by_name)
    if (stages.*stage) names.emplace_back(name);
  return names;
}

Result<StressOptions> parse(const StressArguments& arguments) {
  StressOptions options;
  options.run = arguments.run;
  session::RunOptions& run = options.run;
  if (const auto fine = parse_loop(arguments, run); !fine) return fine.error();
  const auto duration = cli::parse_duration(arguments.duration);
  if (!duration) return duration.error();
  run.duration_s = *duration;
  auto load = parse_load(arguments.load);
  if (!load) return load.error();
  options.load = *std::move(load);
  auto conditions = parse_conditions(arguments.fail_if);
  if (!conditions) return conditions.error();
  options.conditions = *std::move(conditions);
  if (arguments.break_us) {
    if (!(*arguments.break_us > 0.0 && *arguments.break_us <= 1e9))
      return usage("--break: use a lateness in microseconds above 0");
    options.break_at = std::chrono::nanoseconds(std::llround(*arguments.break_us * 1e3));
  }
  if (arguments.histogram_us &&
      (*arguments.histogram_us < 1 || *arguments.histogram_us > 1'000'000))
    return usage("--histogram: use 1 to 1000000 microseconds");
  if (!(arguments.floor_s >= 0.0 && arguments.floor_s <= 3600.0))
    return usage("--floor: use 0 (not measured) to 3600 seconds");
  options.floor_s = arguments.floor_s;
  constexpr double max_changes = 6000.0; // at most one in each look of the main thread
  if (!(arguments.changes_per_minute >= 0.0 && arguments.changes_per_minute <= max_changes))
    return usage("--changes: use 0 to 6000 per minute");
  if (arguments.changes_per_minute > 0.0 && !(run.loop.stages.input && run.loop.stages.deform))
    return usage("--changes: needs the stages input and deform");
  options.changes_per_minute = arguments.changes_per_minute;
  if (run.left.empty() && run.right.empty()) run.left = run.right = "sim";
  if (run.mesh.empty()) run.mesh = cli::shipped_model("moai.obj").string();
  return options;
}

} // namespace nendo::stress
