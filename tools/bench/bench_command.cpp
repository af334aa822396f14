// The commands of nendo bench.

#include "bench/bench.hpp"

namespace nendo::bench {
void add_bench(cli::Command& program) {
  cli::Command bench = program.add_command(
      "bench", "Measures this program on this machine: latency, faults, load, loop, rings, hands, "
               "calibration, fields, deformation, clay, cuts, joins");
  bench.require_command();
  calibration_bench::add(bench);
  clay_bench::add(bench);
  cut_bench::add(bench);
  deform_bench::add(bench);
  latency_bench::add(bench);
  faults_bench::add(bench);
  hand_bench::add(bench);
  join_bench::add(bench);
  models_bench::add(bench);
  rt_bench::add(bench);
  scale_bench::add(bench);
  soak_bench::add(bench);
  solve_bench::add(bench);
  table1_bench::add(bench);
  wearers_bench::add(bench);
}

} // namespace nendo::bench
