#pragma once
// The commands of nendo bench, one a file.

#include "command.hpp"

namespace nendo::app {

void add_calibration_bench(Command& bench);
void add_deform_bench(Command& bench);
void add_latency_bench(Command& bench);
void add_faults_bench(Command& bench);
void add_hand_bench(Command& bench);
void add_rt_bench(Command& bench);
void add_scale_bench(Command& bench);
void add_soak_bench(Command& bench);
void add_solve_bench(Command& bench);
void add_table1_bench(Command& bench);

} // namespace nendo::app
