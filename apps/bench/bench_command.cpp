// nendo bench: what this machine, and this program on it, can do.

#include "bench/bench.hpp"
#include "commands.hpp"

namespace nendo::app {

void add_bench(Command& program) {
  Command bench = program.add_command(
      "bench", "Measures this program on this machine: latency, faults, load, loop, rings, hands, "
               "calibration, fields, deformation");
  bench.require_command();
  add_calibration_bench(bench);
  add_deform_bench(bench);
  add_latency_bench(bench);
  add_faults_bench(bench);
  add_hand_bench(bench);
  add_rt_bench(bench);
  add_scale_bench(bench);
  add_soak_bench(bench);
  add_solve_bench(bench);
  add_table1_bench(bench);
}

} // namespace nendo::app
