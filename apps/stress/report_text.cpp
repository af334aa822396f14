#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/driver/record_counts.hpp>

#include "stress/report.hpp"
#include "stress/verdict.hpp"

namespace nendo::stress {
namespace {

using nlohmann::ordered_json;

std::string shown(double us) {
  char text[32];
  std::snprintf(text, sizeof text, us < 100.0 ? "%.2f" : us < 10'000.0 ? "%.1f" : "%.0f", us);
  return text;
}

std::string words(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

/// What each measure is, where its figures stand.
constexpr std::array<std::string_view, measure_names.size()> meanings{
    "from a tick's deadline until it began", "what its length differs from the period by",
    "from its beginning until its frame was published", "how long a sample waited for the tick",
    "from a sample's last byte to the frame that shows it"};

/// Returns a part of the earlier report, or null if it has none.
ordered_json part(const ordered_json& whole, const std::string& key) {
  return whole.is_object() && whole.contains(key) ? whole[key] : ordered_json(nullptr);
}

void print_row(std::FILE* out, const std::string& name, const flow::Histogram& histogram,
               const ordered_json& earlier) {
  const auto figures = figures_of(histogram);
  if (!figures) return;
  std::fprintf(out, "  %-26s", name.c_str());
  for (const double us : figures->us)
    std::fprintf(out, " %9s", shown(us).c_str());
  std::fprintf(out, "\n");
  if (!earlier.is_object()) return;
  std::fprintf(out, "  %-26s", "    earlier");
  for (const auto column : Figures::names) {
    const ordered_json value = part(earlier, std::string(column));
    std::fprintf(out, " %9s", value.is_number() ? shown(value.get<double>()).c_str() : "-");
  }
  std::fprintf(out, "\n");
}

void print_table(std::FILE* out, const StressOutcome& outcome, const ordered_json& earlier) {
  const TickTally& tally = outcome.tally;
  std::fprintf(out,
               "\n  p50: half of the values are no greater; p99: 99 %% of them, and so on. The "
               "first row counts the ticks\n  that ran, \"per scheduled tick\" each tick that "
               "was due, so that a long stall counts for all it prevented.\n");
  std::fprintf(out, "\n  %-26s", "microseconds");
  for (const auto column : Figures::names) {
    std::string heading(column);
    std::replace(heading.begin(), heading.end(), '_', '.');
    std::fprintf(out, " %9s", heading.c_str());
  }
  std::fprintf(out, "\n");
  for (std::size_t k = 0; k < measure_names.size(); ++k) {
    const Distribution& of = tally[static_cast<Measure>(k)];
    const std::string key = std::string(measure_names[k]) + "_us";
    std::fprintf(out, "  %s: %s\n", words(measure_names[k]).c_str(), meanings[k].data());
    print_row(out, words(measure_names[k]), of.raw, part(earlier, key));
    print_row(out, "  per scheduled tick", of.corrected, part(part(earlier, "corrected"), key));
  }
  std::fprintf(out, "  the work, by stage of the tick:\n");
  for (std::size_t k = 1; k < phase_names.size(); ++k) {
    const std::string stage(phase_names[k]);
    print_row(out, "  " + stage, tally.stage(static_cast<Phase>(k)),
              part(part(earlier, "stages_us"), stage));
  }
  if (outcome.floor.spun_s <= 0.0) return;
  std::fprintf(out, "  the machine's own gaps: those of a thread that does nothing but read the "
                    "clock; no program can be better\n");
  print_row(out, "the machine's own gaps", outcome.floor.gaps,
            part(part(earlier, "floor"), "gaps_us"));
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : ", ") + word;
  return text;
}

void print_environment(std::FILE* out, const StressOptions& options, const StressOutcome& outcome) {
  const Environment& machine = outcome.environment;
  const flow::LoopOptions& loop = options.run.loop;
  std::fprintf(out, "nendo stress: %.1f s at %g Hz, policy %s%s%s\n", outcome.elapsed_s,
               loop.rate_hz, flow::describe_policy(loop).c_str(),
               outcome.spins ? ", spinning to each deadline" : "",
               loop.sculptor.deformer.evaluation.threads == 2 ? ", two threads" : "");
  std::fprintf(out, "  %-14s Linux %s%s%s, %u CPUs%s\n", "machine", machine.kernel.c_str(),
               machine.preemption.empty() ? "" : " ", machine.preemption.c_str(), machine.cpus,
               machine.hypervisor ? ", virtual: the host may stop it at any time" : "");
  std::fprintf(out, "  %-14s %s, governor %s, clock %s\n", "", machine.processor.c_str(),
               machine.governor.empty() ? "none" : machine.governor.c_str(),
               machine.clock_source.c_str());
  const std::string load = options.load.empty() ? "" : "; own load " + joined(options.load);
  std::fprintf(out, "  %-14s %s; %td vertices, %s%s\n", "ticks",
               joined(stage_names(loop.stages)).c_str(), outcome.vertices,
               std::string(flow::name_of(loop.sculptor.mode)).c_str(), load.c_str());
  if (outcome.pictures > 0)
    std::fprintf(out, "  %-14s %llu pictures in the live window meanwhile\n", "looked on",
                 static_cast<unsigned long long>(outcome.pictures));
  for (const auto& grant : outcome.grants) {
    const std::string how = " (" + grant.why + "); to have it, " + grant.remedy;
    std::fprintf(out, "  %-14s %s%s\n", grant.granted ? "granted" : "REFUSED", grant.wanted.c_str(),
                 grant.granted ? "" : how.c_str());
  }
}

void print_counts(std::FILE* out, const StressOutcome& outcome) {
  const TickTally& tally = outcome.tally;
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::fprintf(out,
               "\n  %llu ticks, %llu overruns (ticks after which a deadline had passed), %llu "
               "deadlines missed\n  (at which no tick began); longest from tick to tick %s us\n",
               number(tally.ticks()), number(outcome.overruns), number(outcome.missed),
               shown(static_cast<double>(tally.longest_outage().count()) / 1e3).c_str());
  for (std::size_t at = 0; at < outcome.glove_records.size(); ++at)
    std::fprintf(out, "  %s: %s\n", outcome.gloves[at].c_str(),
                 driver::in_words(outcome.glove_records[at]).c_str());
  std::fprintf(out,
               "  %ld page faults: memory that had to be fetched (%ld from disk); %ld involuntary "
               "switches: other\n  threads took the CPU; %.1f %% of a CPU used",
               outcome.costs.minor_faults + outcome.costs.major_faults, outcome.costs.major_faults,
               outcome.costs.involuntary_switches,
               100.0 * outcome.costs.cpu_s / std::max(outcome.elapsed_s, 1e-9));
  if (outcome.stolen_s) std::fprintf(out, ", %.2f s stolen by the host", *outcome.stolen_s);
  std::fprintf(out, "\n");
  if (outcome.floor.spun_s > 0.0) {
    std::fprintf(
        out,
        "  this machine stopped a thread that did nothing but look at the clock for %.2f %% "
        "of %.1f s\n",
        100.0 * outcome.floor.stalled_s / outcome.floor.spun_s, outcome.floor.spun_s);
  }
  if (outcome.records_refused > 0)
    std::fprintf(out,
                 "  %llu ticks are not in these figures: this program was too busy to take them\n",
                 number(outcome.records_refused));
}

void print_changes(std::FILE* out, const StressOptions& options, const StressOutcome& outcome) {
  if (!outcome.by_changes) return;
  std::fprintf(out, "\n  %llu changes of the radius, %g a minute in every other second:\n",
               static_cast<unsigned long long>(outcome.changes), options.changes_a_minute);
  for (const bool with : {false, true}) {
    const ChangeTally& tally = (*outcome.by_changes)[with ? 1 : 0];
    const auto figure = [](const flow::Histogram& of, double fraction) {
      return shown(to_microseconds(of.percentile(fraction)));
    };
    std::fprintf(out,
                 "  %-10s %llu ticks, %llu deadlines missed; late p50 %s, p99 %s, max %s us; work "
                 "p50 %s, p99 %s, max %s us\n",
                 with ? "with" : "without", static_cast<unsigned long long>(tally.ticks),
                 static_cast<unsigned long long>(tally.missed), figure(tally.lateness, 0.5).c_str(),
                 figure(tally.lateness, 0.99).c_str(),
                 shown(to_microseconds(tally.lateness.max())).c_str(),
                 figure(tally.work, 0.5).c_str(), figure(tally.work, 0.99).c_str(),
                 shown(to_microseconds(tally.work.max())).c_str());
  }
}

void print_incidents(std::FILE* out, const StressOutcome& outcome) {
  const TickTally& tally = outcome.tally;
  std::string line;
  for (std::size_t k = 0; k < cause_names.size(); ++k) {
    const std::uint64_t incidents = tally.causes()[k].incidents;
    if (incidents == 0) continue;
    line +=
        (line.empty() ? "" : ", ") + std::to_string(incidents) + " " + std::string(cause_names[k]);
  }
  if (!line.empty()) {
    std::fprintf(out, "\n  later than 1 ms: %s; %.1f %% of that lateness is explained\n",
                 line.c_str(), 100.0 * tally.explained());
    std::fprintf(out, "  (host gap: nothing here ran; own work: the tick's; input: the gloves'; "
                      "preemption: another thread ran)\n");
  }
  std::fprintf(out, "\n  the worst\n  %-28s %10s %7s  %-8s %-10s\n", "time (UTC)", "late us",
               "missed", "phase", "cause");
  for (const Incident& worst : tally.worst()) {
    std::fprintf(out, "  %-28s %10s %7u  %-8s %-10s\n", wall_time(outcome, worst.due).c_str(),
                 shown(to_microseconds(worst.lateness)).c_str(), worst.missed,
                 phase_names[static_cast<std::size_t>(worst.phase)].data(),
                 cause_names[static_cast<std::size_t>(worst.cause)].data());
  }
}

} // namespace

void print_stress(std::FILE* out, const StressOptions& options, const StressOutcome& outcome,
                  const ordered_json& earlier) {
  std::fprintf(out, "%s\n\n", in_words(judge(options, outcome), options, outcome).c_str());
  print_environment(out, options, outcome);
  print_counts(out, outcome);
  print_table(out, outcome, earlier);
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
  std::printf("\n# Histogram\n");
  for (std::size_t us = 0; us < counts.size(); ++us)
    std::printf("%06zu %06llu\n", us, static_cast<unsigned long long>(counts[us]));
  std::printf("# Histogram Overflows: %llu\n", static_cast<unsigned long long>(beyond));
}

std::string hgrm(const flow::Histogram& lateness) {
  std::string text = "       Value     Percentile TotalCount 1/(1-Percentile)\n\n";
  char line[128];
  double sum_us = 0.0;
  double squares = 0.0;
  std::uint64_t seen = 0;
  std::size_t classes = 0;
  lateness.for_each([&](std::chrono::nanoseconds value, std::uint64_t count) {
    const double us = static_cast<double>(value.count()) / 1e3;
    seen += count;
    ++classes;
    sum_us += us * static_cast<double>(count);
    squares += us * us * static_cast<double>(count);
    const double fraction = static_cast<double>(seen) / static_cast<double>(lateness.count());
    std::snprintf(line, sizeof line, "%12.3f %14.12f %10llu", us, fraction,
                  static_cast<unsigned long long>(seen));
    text += line;
    if (seen < lateness.count()) {
      std::snprintf(line, sizeof line, " %14.2f", 1.0 / (1.0 - fraction));
      text += line;
    }
    text += '\n';
  });
  const double n = std::max(1.0, static_cast<double>(lateness.count()));
  const double mean = sum_us / n;
  const double deviation = std::sqrt(std::max(0.0, squares / n - mean * mean));
  std::snprintf(line, sizeof line, "#[Mean    = %12.3f, StdDeviation   = %12.3f]\n", mean,
                deviation);
  text += line;
  std::snprintf(line, sizeof line, "#[Max     = %12.3f, Total count    = %12llu]\n",
                static_cast<double>(lateness.max().count()) / 1e3,
                static_cast<unsigned long long>(lateness.count()));
  text += line;
  std::snprintf(line, sizeof line, "#[Buckets = %12d, SubBuckets     = %12d]\n", 35, 64);
  return text + line;
}

} // namespace nendo::stress
