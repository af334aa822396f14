// nendo bench: what this machine, and this program on it, can do.

#include "bench/bench.hpp"
#include "cli.hpp"

namespace nendo::app {

void add_bench(CLI::App& app, int& exit_code) {
  CLI::App& bench =
      *app.add_subcommand("bench", "Measures this program on this machine: latency, faults, load");
  bench.require_subcommand(1);
  add_latency_bench(bench, exit_code);
  add_faults_bench(bench, exit_code);
  add_soak_bench(bench, exit_code);
}

} // namespace nendo::app
