#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/driver/record_counts.hpp>

#include "cli/figures.hpp"
#include "cli/print.hpp"
#include "stress/report.hpp"

namespace nendo::stress {
namespace {

using nlohmann::ordered_json;

std::string shown(double us) {
  return fmt::format("{:.{}f}", us, us < 100.0 ? 2 : us < 10'000.0 ? 1 : 0);
}

std::string words(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

/// The explanation of each measure, above its figures.
constexpr std::array<std::string_view, measure_names.size()> meanings{
    "from a tick's deadline until it began", "the difference of its length from the period",
    "from its beginning until its frame was published", "how long a sample waited for the tick",
    "from a sample's last byte to the frame that shows it"};

/// Returns a part of a report, or null if it has none.
ordered_json part(const ordered_json& report, const std::string& path) {
  const ordered_json::json_pointer place(path);
  return report.contains(place) ? report.at(place) : ordered_json(nullptr);
}

void print_figures(std::FILE* out, std::string_view name, const ordered_json& figures) {
  cli::print(out, "  {:<26}", name);
  for (const auto column : figure_names) {
    const ordered_json value = part(figures, "/" + std::string(column));
    cli::print(out, " {:>9}", value.is_number() ? shown(value.get<double>()) : "-");
  }
  cli::print(out, "\n");
}

void print_table(std::FILE* out, const ordered_json& report, const ordered_json& earlier) {
  const auto print_row = [&](std::string_view name, const std::string& path) {
    const ordered_json figures = part(report, path);
    if (!figures.is_object()) return;
    print_figures(out, name, figures);
    if (const ordered_json then = part(earlier, path); then.is_object())
      print_figures(out, "    earlier", then);
  };
  cli::print(out, "\n  p50: half of the values are no greater; p99: 99 % of them, and so on. The "
                  "first row counts the ticks\n  that ran, \"per scheduled tick\" each tick that "
                  "was due, so that a long stall counts for each tick that it prevented.\n");
  cli::print(out, "\n  {:<26}", "microseconds");
  for (const auto column : figure_names) {
    std::string heading(column);
    std::replace(heading.begin(), heading.end(), '_', '.');
    cli::print(out, " {:>9}", heading);
  }
  cli::print(out, "\n");
  for (std::size_t k = 0; k < measure_names.size(); ++k) {
    const std::string key = std::string(measure_names[k]) + "_us";
    const std::string name = words(measure_names[k]);
    cli::print(out, "  {}: {}\n", name, meanings[k]);
    print_row(name, "/" + key);
    print_row("  per scheduled tick", "/corrected/" + key);
  }
  cli::print(out, "  the work, by stage of the tick:\n");
  for (const auto& [stage, figures] : report["stages_us"].items())
    print_row("  " + stage, "/stages_us/" + stage);
  if (!report["floor"].is_object()) return;
  cli::print(out, "  the machine's own gaps: those of a thread that only reads the clock; no "
                  "program can be better\n");
  print_row("the machine's own gaps", "/floor/gaps_us");
}

void print_environment(std::FILE* out, const StressOptions& options, const StressOutcome& outcome) {
  const Environment& machine = outcome.environment;
  const flow::LoopOptions& loop = options.run.loop;
  cli::print(out, "nendo stress: {:.1f} s at {:g} Hz, policy {}{}{}\n", outcome.elapsed_s,
             loop.rate_hz, flow::describe_policy(loop),
             outcome.spins ? ", spinning to each deadline" : "",
             loop.sculptor.deformer.evaluation.threads == 2 ? ", two threads" : "");
  cli::print(out, "  {:<14} Linux {}{}{}, {} CPUs{}\n", "machine", machine.kernel,
             machine.preemption.empty() ? "" : " ", machine.preemption, machine.cpus,
             machine.hypervisor ? ", virtual: the host may stop it at any time" : "");
  cli::print(out, "  {:<14} {}, governor {}, clock {}\n", "", machine.processor,
             machine.governor.empty() ? "none" : machine.governor, machine.clock_source);
  cli::print(out, "  {:<14} {}; {} vertices, {}{}{}\n", "ticks",
             cli::joined(stage_names(loop.stages)), outcome.vertices,
             flow::name_of(loop.sculptor.mode), options.load.empty() ? "" : "; own load ",
             cli::joined(options.load));
  if (outcome.pictures > 0)
    cli::print(out, "  {:<14} {} pictures in the live window\n", "observer", outcome.pictures);
  for (const auto& grant : outcome.grants) {
    const std::string how = " (" + grant.why + "); to get it, " + grant.remedy;
    cli::print(out, "  {:<14} {}{}\n", grant.granted ? "granted" : "REFUSED", grant.wanted,
               grant.granted ? "" : how);
  }
}

void print_counts(std::FILE* out, const StressOutcome& outcome) {
  const TickTally& tally = outcome.tally;
  cli::print(out,
             "\n  {} ticks, {} overruns (ticks after which a deadline had passed), {} deadlines "
             "missed\n  (at which no tick began); longest from tick to tick {} us\n",
             tally.ticks(), outcome.overruns, outcome.missed,
             shown(to_microseconds(tally.longest_outage())));
  for (std::size_t at = 0; at < outcome.glove_records.size(); ++at)
    cli::print(out, "  {}: {}\n", outcome.gloves[at], driver::in_words(outcome.glove_records[at]));
  cli::print(out,
             "  {} page faults: memory that had to be fetched ({} from disk); {} involuntary "
             "switches: other\n  threads took the CPU; {:.1f} % of a CPU used",
             outcome.costs.minor_faults + outcome.costs.major_faults, outcome.costs.major_faults,
             outcome.costs.involuntary_switches,
             100.0 * outcome.costs.cpu_s / std::max(outcome.elapsed_s, 1e-9));
  if (outcome.stolen_s) cli::print(out, ", {:.2f} s stolen by the host", *outcome.stolen_s);
  cli::print(out, "\n");
  if (outcome.floor.spun_s > 0.0)
    cli::print(
        out, "  this machine stopped a thread that only read the clock for {:.2f} % of {:.1f} s\n",
        100.0 * outcome.floor.stalled_s / outcome.floor.spun_s, outcome.floor.spun_s);
  if (outcome.records_refused > 0)
    cli::print(out, "  {} ticks are not in these figures: this program was too busy to read them\n",
               outcome.records_refused);
}

void print_changes(std::FILE* out, const StressOptions& options, const StressOutcome& outcome) {
  if (!outcome.by_changes) return;
  cli::print(out, "\n  {} changes of the radius, {:g} per minute in every other second:\n",
             outcome.changes, options.changes_per_minute);
  const auto figures = [](const flow::Histogram& of) {
    const auto at = [&](double fraction) {
      return shown(to_microseconds(of.percentile(fraction)));
    };
    return fmt::format("p50 {}, p99 {}, max {} us", at(0.5), at(0.99), at(1.0));
  };
  for (const bool with : {false, true}) {
    const ChangeTally& tally = (*outcome.by_changes)[with ? 1 : 0];
    cli::print(out, "  {:<10} {} ticks, {} deadlines missed; late {}; work {}\n",
               with ? "with" : "without", tally.ticks, tally.missed, figures(tally.lateness),
               figures(tally.work));
  }
}

void print_incidents(std::FILE* out, const StressOutcome& outcome) {
  const TickTally& tally = outcome.tally;
  std::string line;
  for (std::size_t k = 0; k < cause_names.size(); ++k)
    if (const std::uint64_t incidents = tally.causes()[k].incidents; incidents > 0)
      line += fmt::format("{}{} {}", line.empty() ? "" : ", ", incidents, cause_names[k]);
  if (!line.empty())
    cli::print(
        out,
        "\n  later than 1 ms: {}; {:.1f} % of that lateness is explained\n  (host gap: nothing "
        "here ran; own work: the tick's; input: the gloves'; preemption: another thread "
        "ran)\n",
        line, 100.0 * tally.explained());
  cli::print(out, "\n  the worst\n  {:<28} {:>10} {:>7}  {:<8} {:<10}\n", "time (UTC)", "late us",
             "missed", "phase", "cause");
  for (const Incident& worst : tally.worst())
    cli::print(out, "  {:<28} {:>10} {:>7}  {:<8} {:<10}\n", wall_time(outcome, worst.due),
               shown(to_microseconds(worst.lateness)), worst.missed,
               phase_names[static_cast<std::size_t>(worst.phase)],
               cause_names[static_cast<std::size_t>(worst.cause)]);
}

} // namespace

void print_stress(std::FILE* out, const StressOptions& options, const StressOutcome& outcome,
                  const ordered_json& report, const ordered_json& earlier) {
  cli::print(out, "{}\n\n", report["verdict"]["text"].get<std::string>());
  print_environment(out, options, outcome);
  print_counts(out, outcome);
  print_table(out, report, earlier);
  print_changes(out, options, outcome);
  print_incidents(out, outcome);
  std::fflush(out);
}

void print_histogram(const flow::Histogram& lateness, unsigned max_us) {
  std::vector<std::uint64_t> counts(max_us);
  std::uint64_t beyond = 0;
  lateness.for_each([&](std::chrono::nanoseconds value, std::uint64_t count) {
    const auto us = static_cast<std::uint64_t>(value.count()) / 1000;
    us < max_us ? counts[us] += count : beyond += count;
  });
  cli::print("\n# Histogram\n");
  for (std::size_t us = 0; us < counts.size(); ++us)
    cli::print("{:06} {:06}\n", us, counts[us]);
  cli::print("# Histogram Overflows: {}\n", beyond);
}

std::string hgrm(const flow::Histogram& lateness) {
  std::string text = "       Value     Percentile TotalCount 1/(1-Percentile)\n\n";
  double sum_us = 0.0;
  double squares = 0.0;
  std::uint64_t seen = 0;
  lateness.for_each([&](std::chrono::nanoseconds value, std::uint64_t count) {
    const double us = to_microseconds(value);
    seen += count;
    sum_us += us * static_cast<double>(count);
    squares += us * us * static_cast<double>(count);
    const double fraction = static_cast<double>(seen) / static_cast<double>(lateness.count());
    text += fmt::format("{:12.3f} {:14.12f} {:10}", us, fraction, seen);
    if (seen < lateness.count()) text += fmt::format(" {:14.2f}", 1.0 / (1.0 - fraction));
    text += '\n';
  });
  const double n = std::max(1.0, static_cast<double>(lateness.count()));
  const double mean = sum_us / n;
  const double deviation = std::sqrt(std::max(0.0, squares / n - mean * mean));
  return text + fmt::format("#[Mean    = {:12.3f}, StdDeviation   = {:12.3f}]\n"
                            "#[Max     = {:12.3f}, Total count    = {:12}]\n"
                            "#[Buckets = {:12}, SubBuckets     = {:12}]\n",
                            mean, deviation, to_microseconds(lateness.max()), lateness.count(), 35,
                            64);
}

} // namespace nendo::stress
