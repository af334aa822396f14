#pragma once
// The commands of nendo bench. Each has a file and a namespace of its own, and a function add_X()
// that describes it.

#include "cli/command.hpp"

namespace nendo::bench {

void add_bench(cli::Command& program);

void add_calibration(cli::Command& bench);
void add_clay(cli::Command& bench);
void add_cut(cli::Command& bench);
void add_deform(cli::Command& bench);
void add_faults(cli::Command& bench);
void add_hand(cli::Command& bench);
void add_join(cli::Command& bench);
void add_models(cli::Command& bench);
void add_latency(cli::Command& bench);
void add_rt(cli::Command& bench);
void add_scale(cli::Command& bench);
void add_soak(cli::Command& bench);
void add_solve(cli::Command& bench);
void add_table1(cli::Command& bench);
void add_wearers(cli::Command& bench);

} // namespace nendo::bench
