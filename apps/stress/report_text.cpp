#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "stress/report.hpp"

namespace nendo::stress {
namespace {

using nlohmann::ordered_json;

constexpr std::array columns{"min", "p50", "p90", "p99", "p99_9", "p99_99", "max"};

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

void print_row(const std::string& name, const ordered_json& figures, const ordered_json& earlier) {
  if (figures.is_null()) return;
  std::printf("  %-26s", name.c_str());
  for (const char* column : columns)
    std::printf(" %9s", shown(figures[column].get<double>()).c_str());
  std::printf("\n");
  if (!earlier.is_object()) return;
  std::printf("  %-26s", "    earlier");
  for (const char* column : columns) {
    const auto value = earlier.find(column);
    std::printf(" %9s", value != earlier.end() && value->is_number()
                            ? shown(value->get<double>()).c_str()
                            : "-");
  }
  std::printf("\n");
}

ordered_json part(const ordered_json& whole, const std::string& key) {
  return whole.is_object() && whole.contains(key) ? whole[key] : ordered_json(nullptr);
}

void print_table(const ordered_json& report, const ordered_json& earlier) {
  std::printf("\n  %-26s", "microseconds");
  for (const char* column : {"min", "p50", "p90", "p99", "p99.9", "p99.99", "max"})
    std::printf(" %9s", column);
  std::printf("\n");
  for (const auto name : measure_names) {
    const std::string key = std::string(name) + "_us";
    print_row(words(name), report[key], part(earlier, key));
    print_row("  per scheduled tick", report["corrected"][key],
              part(part(earlier, "corrected"), key));
  }
  std::printf("  the work, by stage:\n");
  for (const auto& [stage, figures] : report["stages_us"].items())
    print_row("  " + stage, figures, part(part(earlier, "stages_us"), stage));
  if (report["floor"].is_object())
    print_row("the machine's own gaps", report["floor"]["gaps_us"],
              part(part(earlier, "floor"), "gaps_us"));
}

void print_environment(const StressOutcome& outcome, const ordered_json& report) {
  const Environment& machine = outcome.environment;
  const ordered_json& about = report["environment"];
  std::printf("nendo stress: %.1f s at %g Hz, policy %s%s%s\n", outcome.elapsed_s,
              about["rate_hz"].get<double>(), about["policy"].get<std::string>().c_str(),
              outcome.spins ? ", spinning to each deadline" : "",
              about["threads"] == 2 ? ", two threads" : "");
  std::printf("  %-14s Linux %s%s%s, %u CPUs%s\n", "machine", machine.kernel.c_str(),
              machine.preemption.empty() ? "" : " ", machine.preemption.c_str(), machine.cpus,
              machine.hypervisor ? ", virtual: the host may stop it at any time" : "");
  std::printf("  %-14s %s, governor %s, clock %s\n", "", machine.processor.c_str(),
              machine.governor.empty() ? "none" : machine.governor.c_str(),
              machine.clock_source.c_str());
  std::string stages;
  for (const auto& stage : about["stages"])
    stages += (stages.empty() ? "" : ", ") + stage.get<std::string>();
  std::string load;
  for (const auto& kind : about["load"])
    load += (load.empty() ? "; own load " : ", ") + kind.get<std::string>();
  std::printf("  %-14s %s; %td vertices, %s%s\n", "ticks", stages.c_str(), outcome.vertices,
              about["mode"].get<std::string>().c_str(), load.c_str());
  if (outcome.pictures > 0)
    std::printf("  %-14s %llu pictures in the live window meanwhile\n", "looked on",
                static_cast<unsigned long long>(outcome.pictures));
  for (const auto& grant : outcome.grants) {
    const std::string how = " (" + grant.why + "); to have it, " + grant.remedy;
    std::printf("  %-14s %s%s\n", grant.granted ? "granted" : "REFUSED", grant.wanted.c_str(),
                grant.granted ? "" : how.c_str());
  }
}

void print_counts(const StressOutcome& outcome) {
  const TickTally& tally = outcome.tally;
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf("\n  %llu ticks, %llu overruns, %llu deadlines missed; longest from tick to tick "
              "%s us\n",
              number(tally.ticks()), number(outcome.overruns), number(outcome.missed),
              shown(static_cast<double>(tally.longest_outage().count()) / 1e3).c_str());
  std::printf("  %ld page faults (%ld from disk), %ld involuntary switches, %.1f %% of a CPU",
              outcome.costs.minor_faults + outcome.costs.major_faults, outcome.costs.major_faults,
              outcome.costs.involuntary_switches,
              100.0 * outcome.costs.cpu_s / std::max(outcome.elapsed_s, 1e-9));
  if (outcome.stolen_s) std::printf(", %.2f s stolen by the host", *outcome.stolen_s);
  std::printf("\n");
  if (outcome.floor.spun_s > 0.0) {
    std::printf(
        "  this machine stopped a thread that did nothing but look at the clock for %.2f %% "
        "of %.1f s\n",
        100.0 * outcome.floor.stalled_s / outcome.floor.spun_s, outcome.floor.spun_s);
  }
  if (outcome.records_refused > 0)
    std::printf("  %llu ticks are not in these figures: this program was too busy to take them\n",
                number(outcome.records_refused));
}

void print_incidents(const ordered_json& report) {
  const ordered_json& incidents = report["incidents"];
  std::string line;
  for (const auto& [cause, share] : incidents["by_cause"].items()) {
    if (share["incidents"] == 0) continue;
    line += (line.empty() ? "" : ", ") + std::to_string(share["incidents"].get<std::uint64_t>()) +
            " " + cause;
  }
  if (!line.empty()) {
    std::printf("\n  later than 1 ms: %s; %.1f %% of that lateness is explained\n", line.c_str(),
                100.0 * incidents["explained"].get<double>());
  }
  std::printf("\n  the worst\n  %-28s %10s %7s  %-8s %-10s\n", "time (UTC)", "late us", "missed",
              "phase", "cause");
  for (const auto& worst : report["worst"]) {
    std::printf("  %-28s %10s %7u  %-8s %-10s\n", worst["time"].get<std::string>().c_str(),
                shown(worst["lateness_us"].get<double>()).c_str(), worst["missed"].get<unsigned>(),
                worst["phase"].get<std::string>().c_str(),
                worst["cause"].get<std::string>().c_str());
  }
}

} // namespace

void print_stress(const StressOutcome& outcome, const ordered_json& report,
                  const ordered_json& earlier) {
  print_environment(outcome, report);
  print_counts(outcome);
  print_table(report, earlier);
  print_incidents(report);
  std::fflush(stdout);
}

void print_histogram(const flow::Histogram& lateness, unsigned most_us) {
  std::vector<std::uint64_t> counts(most_us);
  std::uint64_t beyond = 0;
  lateness.for_each([&](std::chrono::nanoseconds value, std::uint64_t count) {
    const auto us = static_cast<std::uint64_t>(value.count()) / 1000;
    us < most_us ? counts[us] += count : beyond += count;
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
