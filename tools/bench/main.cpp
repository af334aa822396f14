// The nendo-bench program. `nendo bench` starts it, and its --help speaks as that command.

#include <string_view>
#include <vector>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "bench/bench.hpp"
#include "cli/huge_pages.hpp"
#include "cli/run_main.hpp"

namespace {

int run(int argc, char** argv) {
  // The drivers' log lines must not mix with what a benchmark prints.
  spdlog::set_default_logger(spdlog::stderr_color_mt("nendo"));
  spdlog::set_pattern("nendo: %v");
  char program[] = "nendo";
  char command[] = "bench";
  std::vector<char*> arguments{program, command};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  arguments.push_back(nullptr);
  return nendo::cli::run_program(static_cast<int>(arguments.size()) - 1, arguments.data(),
                                 "Nendo: benchmarks.", nendo::bench::add_bench);
}

} // namespace

int main(int argc, char** argv) {
  // As the commands that these measure. All else is measured as a run works.
  const std::string_view wanted = argc > 1 ? argv[1] : "";
  if (wanted == "cut" || wanted == "join") nendo::cli::use_huge_pages(argv);
  return nendo::cli::run_main("nendo", [&] { return run(argc, argv); });
}
