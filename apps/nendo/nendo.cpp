// The nendo program: one file per command.

#include <algorithm>
#include <array>
#include <csignal>
#include <string_view>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "cli/huge_pages.hpp"
#include "cli/run_main.hpp"
#include "nendo/commands.hpp"

namespace {

/// Returns whether a command has no deadlines. Loops with deadlines use no huge pages: with them,
/// some runs of the stress test had ticks of several milliseconds.
bool works_without_a_clock(std::string_view command) {
  constexpr std::array<std::string_view, 7> all{"cut",     "deform", "export", "join",
                                                "picture", "repair", "replay"};
  return std::find(all.begin(), all.end(), command) != all.end();
}

int run(int argc, char** argv) {
  using namespace nendo;
  using namespace nendo::app;
  if (argc > 1 && std::string_view(argv[1]) == "bench") return start_bench(argv + 1);
  // A command whose reader has gone finishes its work: the shape of `nendo run` is still written.
  std::signal(SIGPIPE, SIG_IGN);
  // The drivers' log lines must not mix with what a command prints.
  spdlog::set_default_logger(spdlog::stderr_color_mt("nendo"));
  spdlog::set_pattern("nendo: %v");
  return cli::run_program(argc, argv, program_summary, add_commands);
}

} // namespace

int main(int argc, char** argv) {
  if (argc > 1 && works_without_a_clock(argv[1])) nendo::cli::use_huge_pages(argv);
  return nendo::cli::run_main("nendo", [&] { return run(argc, argv); });
}
