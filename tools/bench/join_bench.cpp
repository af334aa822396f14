// nendo bench join: how long it takes to join two models.

#include <cstdio>

#include <nlohmann/json.hpp>

#include "bench/bench.hpp"
#include "bench/join_trial.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"

namespace nendo::bench::join_bench {
namespace {

struct Options {
  bool short_form = false;
  bool json = false;
};

void print_json(const JoinTrial& trial) {
  cli::print_line({{"triangles", trial.triangles},
                   {"crossings", trial.crossings},
                   {"sharp_ms", trial.sharp_ms},
                   {"smeared_ms", trial.smeared_ms},
                   {"volume_error", trial.volume_error}});
}

int bench_join(const Options& options) {
  if (!options.json)
    cli::print("two balls with texture coordinates, colours and materials, half a diameter apart; "
               "ms, the best of five\n{:>12} {:>10} {:>10} {:>10} {:>12}\n",
               "triangles", "crossings", "sharp", "blended", "volume err");
  for (const std::size_t rings : {40U, 87U, 160U, 400U}) {
    if (options.short_form && rings > 40) break;
    const JoinTrial trial = measure_join(rings, options.short_form ? 1 : 5);
    if (!trial.fine) return cli::report(Error{Errc::failed, "the balls were not joined"});
    if (options.json)
      print_json(trial);
    else
      cli::print("2 x {:8} {:10} {:10.1f} {:10.1f} {:12.1e}\n", trial.triangles, trial.crossings,
                 trial.sharp_ms, trial.smeared_ms, trial.volume_error);
    std::fflush(stdout);
  }
  return 0;
}

} // namespace
} // namespace nendo::bench::join_bench

void nendo::bench::add_join(cli::Command& bench) {
  using namespace join_bench;
  cli::Command command = bench.add_command(
      "join", "Measures the join of two models, with a sharp and with a blended seam");
  Options& options = command.on_chosen<Options>(bench_join);
  command.add_flag("--short", options.short_form, "Measure only small models, once");
  command.add_flag("--json", options.json, "One JSON object per line");
}
