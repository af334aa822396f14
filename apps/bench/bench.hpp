#pragma once
// The subcommands of nendo bench, one a file.

#include <CLI/CLI.hpp>

namespace nendo::app {

void add_latency_bench(CLI::App& bench, int& exit_code);
void add_faults_bench(CLI::App& bench, int& exit_code);
void add_soak_bench(CLI::App& bench, int& exit_code);

} // namespace nendo::app
