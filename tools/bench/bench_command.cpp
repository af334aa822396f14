// The commands of nendo bench.

#include "bench/bench.hpp"

namespace nendo::bench {
void add_bench(cli::Command& program) {
  cli::Command bench = program.add_command(
      "bench", "Measures this program on this machine: latency, faults, load, loop, rings, hands, "
               "calibration, fields, deformation, clay, cuts, joins");
  bench.require_command();
  add_calibration(bench);
  add_clay(bench);
  add_cut(bench);
  add_deform(bench);
  add_latency(bench);
  add_faults(bench);
  add_hand(bench);
  add_join(bench);
  add_models(bench);
  add_rt(bench);
  add_scale(bench);
  add_soak(bench);
  add_solve(bench);
  add_table1(bench);
  add_wearers(bench);
}

} // namespace nendo::bench
