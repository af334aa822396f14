// nendo bench faults: the fault matrix, as a table for people, for the documents, or for programs.

#include <algorithm>
#include <cstdio>
#include <iostream>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "bench/bench.hpp"
#include "bench/fault_matrix.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"

namespace nendo::bench::faults_bench {
namespace {

struct Options {
  double seconds = 8.0;
  unsigned at_once = 16;
  bool json = false;
  bool markdown = false;
};

void print_json(const FaultOutcome& outcome) {
  const driver::StreamStats& stats = outcome.stats;
  cli::print_line({{"fault", outcome.fault->name},
                   {"glove", outcome.glove->name},
                   {"sent", outcome.sent},
                   {"faulted", outcome.faulted},
                   {"delivered", outcome.delivered},
                   {"missed", stats.missed},
                   {"bad_records", stats.bad_records},
                   {"implausible", stats.implausible},
                   {"unplugged", stats.unplugged},
                   {"silences", stats.silences},
                   {"reopened", stats.reopened},
                   {"flipped", outcome.flipped},
                   {"broken", outcome.broken},
                   {"longest_gap_s", outcome.longest_gap_s},
                   {"allowed_gap_s", outcome.fault->longest_gap_s},
                   {"complaint", outcome.complaint}});
}

/// Prints a line per fault, over all gloves: sums, and the longest gap.
void print_summary(const std::vector<FaultOutcome>& outcomes, bool markdown) {
  cli::print("{}", markdown
                       ? "| fault | what happens | sent | delivered | missed | bad | flipped | "
                         "broken | longest gap, s "
                         "|\n|---|---|---|---|---|---|---|---|---|\n"
                       : "fault            sent delivered missed   bad flipped broken  gap s\n");
  for (std::size_t k = 0; k < outcomes.size(); k += glove_cases().size()) {
    FaultOutcome sum = outcomes[k];
    for (std::size_t glove = 1; glove < glove_cases().size(); ++glove) {
      const FaultOutcome& other = outcomes[k + glove];
      sum.sent += other.sent;
      sum.delivered += other.delivered;
      sum.stats.missed += other.stats.missed;
      sum.stats.bad_records += other.stats.bad_records;
      sum.flipped += other.flipped;
      sum.broken += other.broken;
      sum.longest_gap_s = std::max(sum.longest_gap_s, other.longest_gap_s);
    }
    cli::print(fmt::runtime(markdown ? "| {} | {} | {} | {} | {} | {} | {} | {} | {:.2f} |\n"
                                     : "{:15} {:.0} {:4} {:9} {:6} {:5} {:7} {:6} {:6.2f}\n"),
               sum.fault->name, sum.fault->happens, sum.sent, sum.delivered, sum.stats.missed,
               sum.stats.bad_records, sum.flipped, sum.broken, sum.longest_gap_s);
  }
  std::fflush(stdout);
}

int bench_faults(const Options& options) {
  if (!(options.seconds >= 6.0 && options.seconds <= 3600.0)) {
    return cli::report(
        {Errc::usage, "--seconds: use 6 to 3600 per case; a fault begins after 2 s"});
  }
  if (options.at_once == 0 || options.at_once > 64) {
    return cli::report({Errc::usage, "--at-once: use 1 to 64 cases"});
  }
  cli::install_stop_signals();
  spdlog::set_level(spdlog::level::off); // the drivers log each fault
  const auto outcomes = run_fault_matrix(options.seconds, options.at_once, cli::stop_requested());
  if (!outcomes) return cli::report(outcomes.error());
  if (cli::stop_requested())
    return cli::report({Errc::failed, "stopped before all cases were run"});
  if (!options.json) print_summary(*outcomes, options.markdown);
  std::size_t complaints = 0;
  for (const FaultOutcome& outcome : *outcomes) {
    if (options.json) print_json(outcome);
    if (outcome.complaint.empty()) continue;
    ++complaints;
    if (!options.json) {
      std::cerr << outcome.fault->name << ", " << outcome.glove->name << ": " << outcome.complaint
                << '\n';
    }
  }
  if (complaints == 0) return 0;
  return cli::report({Errc::failed, std::to_string(complaints) + " of " +
                                        std::to_string(outcomes->size()) + " cases failed"});
}

} // namespace
} // namespace nendo::bench::faults_bench

void nendo::bench::add_faults(cli::Command& bench) {
  using namespace faults_bench;
  cli::Command command = bench.add_command(
      "faults",
      "Measures the records that each fault costs each CyberGlove, through the real driver");
  Options& options = command.on_chosen<Options>(bench_faults);
  command.add_duration("--seconds", options.seconds, "Seconds per case");
  command.add_option("--at-once", options.at_once, "Number of cases that run at the same time");
  command.add_flag("--json", options.json, "One JSON object per case");
  command.add_flag("--markdown", options.markdown, "A table in Markdown");
}
