#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <string>

#include <nlohmann/json.hpp>

#include <nendo/driver/record_counts.hpp>

#include "session/setting_options.hpp"
#include "stress/report.hpp"

namespace nendo::stress {
namespace {

using nlohmann::ordered_json;

/// Returns null if nothing was recorded.
ordered_json figures_json(const flow::Histogram& histogram) {
  if (histogram.count() == 0) return nullptr;
  const auto at = [&](double fraction) { return to_microseconds(histogram.percentile(fraction)); };
  const std::array us{
      to_microseconds(histogram.min()), at(0.50), at(0.90), at(0.99), at(0.999), at(0.9999),
      to_microseconds(histogram.max())};
  ordered_json line{{"count", histogram.count()}};
  for (std::size_t k = 0; k < figure_names.size(); ++k)
    line[std::string(figure_names[k])] = us[k];
  return line;
}

ordered_json environment_json(const StressOptions& options, const StressOutcome& outcome) {
  const Environment& machine = outcome.environment;
  const auto& loop = options.run.loop;
  const auto or_null = [](const std::string& text) {
    return text.empty() ? ordered_json(nullptr) : ordered_json(text);
  };
  ordered_json line{{"kernel", machine.kernel},
                    {"preemption", or_null(machine.preemption)},
                    {"processor", or_null(machine.processor)},
                    {"cpus", machine.cpus},
                    {"hypervisor", machine.hypervisor},
                    {"governor", or_null(machine.governor)},
                    {"clock_source", or_null(machine.clock_source)},
                    {"rt_runtime_us", nullptr},
                    {"rate_hz", loop.rate_hz},
                    {"duration_s", options.run.duration_s},
                    {"policy", flow::describe_policy(loop)},
                    {"spin", outcome.spins},
                    {"threads", loop.sculptor.deformer.evaluation.threads},
                    {"mode", flow::name_of(loop.sculptor.mode)},
                    {"vertices", outcome.vertices},
                    {"gloves", outcome.gloves},
                    {"load", options.load},
                    {"pictures", outcome.pictures},
                    {"realtime", session::grants_json(outcome.grants)}};
  if (machine.rt_runtime_us) line["rt_runtime_us"] = *machine.rt_runtime_us;
  line["stages"] = stage_names(loop.stages);
  return line;
}

ordered_json worst_json(const StressOutcome& outcome) {
  auto lines = ordered_json::array();
  for (const Incident& incident : outcome.tally.worst()) {
    lines.push_back({{"time", wall_time(outcome, incident.due)},
                     {"since_start_s", to_seconds(incident.due - outcome.start)},
                     {"tick", incident.tick},
                     {"lateness_us", to_microseconds(incident.lateness)},
                     {"missed", incident.missed},
                     {"phase", phase_names[static_cast<std::size_t>(incident.phase)]},
                     {"phase_us", to_microseconds(incident.phase_time)},
                     {"cause", cause_names[static_cast<std::size_t>(incident.cause)]}});
  }
  return lines;
}

ordered_json causes_json(const TickTally& tally) {
  ordered_json causes;
  for (std::size_t k = 0; k < cause_names.size(); ++k) {
    const auto& share = tally.causes()[k];
    causes[std::string(cause_names[k])] = {{"incidents", share.incidents},
                                           {"lateness_us", to_microseconds(share.lateness)}};
  }
  return {{"threshold_us", to_microseconds(TickTally::incident_threshold)},
          {"explained", tally.explained()},
          {"by_cause", causes}};
}

ordered_json gloves_json(const StressOutcome& outcome) {
  auto lines = ordered_json::array();
  for (std::size_t at = 0; at < outcome.glove_records.size(); ++at) {
    ordered_json line{{"source", outcome.gloves[at]}};
    for (const auto& [name, count] : driver::by_name(outcome.glove_records[at])) {
      ordered_json& value = line[std::string(name)];
      if (count) value = *count; // otherwise null: not known
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

ordered_json verdict_json(const Verdict& verdict, const StressOptions& options,
                          const StressOutcome& outcome) {
  return {{"text", in_words(verdict, options, outcome)},
          {"punctual", verdict.judged ? ordered_json(verdict.punctual) : ordered_json(nullptr)},
          {"rate_hz", options.run.loop.rate_hz},
          {"due_ticks", verdict.due},
          {"late_ticks", verdict.late},
          {"max_late_us", verdict.max_late_us},
          {"reason", verdict.reason},
          {"remedy", verdict.remedy}};
}

ordered_json floor_json(const PlatformFloor& floor) {
  if (floor.spun_s <= 0.0) return nullptr;
  ordered_json line{{"spun_s", floor.spun_s}, {"stalled_s", floor.stalled_s}};
  line["gaps_us"] = figures_json(floor.gaps);
  return line;
}

ordered_json changes_json(const StressOptions& options, const StressOutcome& outcome) {
  if (!outcome.by_changes) return nullptr;
  ordered_json line{{"a_minute", options.changes_per_minute}, {"taken", outcome.changes}};
  for (const bool with : {false, true}) {
    const ChangeTally& tally = (*outcome.by_changes)[with ? 1 : 0];
    line[with ? "with" : "without"] = {{"ticks", tally.ticks},
                                       {"missed", tally.missed},
                                       {"lateness_us", figures_json(tally.lateness)},
                                       {"work_us", figures_json(tally.work)}};
  }
  return line;
}

} // namespace

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

ordered_json stress_json(const StressOptions& options, const StressOutcome& outcome) {
  const TickTally& tally = outcome.tally;
  const Verdict verdict = judge(options, outcome);
  ordered_json line{{"event", "stress"},
                    {"verdict", verdict_json(verdict, options, outcome)},
                    {"environment", environment_json(options, outcome)},
                    {"elapsed_s", outcome.elapsed_s},
                    {"ticks", tally.ticks()},
                    {"missed", outcome.missed},
                    {"overruns", outcome.overruns},
                    {"failed", outcome.failed},
                    {"samples", tally.samples()},
                    {"gloves", gloves_json(outcome)},
                    {"longest_outage_us", to_microseconds(tally.longest_outage())}};
  ordered_json corrected;
  for (std::size_t k = 0; k < measure_names.size(); ++k) {
    const Distribution& of = tally[static_cast<Measure>(k)];
    const std::string key = std::string(measure_names[k]) + "_us";
    line[key] = figures_json(of.raw);
    corrected[key] = figures_json(of.corrected);
  }
  line["corrected"] = corrected;
  ordered_json stages;
  for (std::size_t k = 1; k < phase_names.size(); ++k)
    stages[std::string(phase_names[k])] = figures_json(tally.stage(static_cast<Phase>(k)));
  line["stages_us"] = stages;
  line["spun_us"] = outcome.spins ? figures_json(tally.stage(Phase::wake)) : nullptr;
  line["changes"] = changes_json(options, outcome);
  line["incidents"] = causes_json(tally);
  line["worst"] = worst_json(outcome);
  line["page_faults"] = outcome.costs.minor_faults + outcome.costs.major_faults;
  line["involuntary_switches"] = outcome.costs.involuntary_switches;
  line["voluntary_switches"] = outcome.costs.voluntary_switches;
  line["cpu_fraction"] = outcome.elapsed_s > 0.0 ? outcome.costs.cpu_s / outcome.elapsed_s : 0.0;
  line["stolen_s"] = outcome.stolen_s ? ordered_json(*outcome.stolen_s) : ordered_json(nullptr);
  line["records_refused"] = outcome.records_refused;
  line["floor"] = floor_json(outcome.floor);
  line["ended"] = outcome.broke ? "break" : outcome.stopped ? "stopped" : "duration";
  return line;
}

std::string different_work(const ordered_json& earlier, const ordered_json& report) {
  struct Kind {
    const char* key;
    const char* name;
  };
  constexpr std::array<Kind, 6> conditions{{{"stages", "stages"},
                                            {"load", "load"},
                                            {"rate_hz", "rate in Hz"},
                                            {"mode", "mode"},
                                            {"vertices", "vertices"},
                                            {"threads", "threads"}}};
  const ordered_json none;
  const auto value_in = [&](const ordered_json& of, const char* key) {
    const ordered_json environment = of.value("environment", none);
    return environment.is_object() ? environment.value(key, none) : none;
  };
  std::string differences;
  for (const auto& [key, name] : conditions) {
    const ordered_json then = value_in(earlier, key);
    const ordered_json now = value_in(report, key);
    if (then == now) continue;
    differences += (differences.empty() ? "" : ", ") + std::string(name) + " " + then.dump() +
                   " then and " + now.dump() + " now";
  }
  return differences;
}

} // namespace nendo::stress
