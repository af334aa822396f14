// nendo bench: starts nendo-bench, a program of its own, so that nobody has to build it.

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include "cli/cli.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::bench_command {

int start(char** arguments) {
  std::error_code unknown;
  const auto program =
      std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path() / "nendo-bench";
  ::execv(program.c_str(), arguments);
  if (errno != ENOENT)
    return cli::report({Errc::failed, program.string() + ": " + std::strerror(errno)});
  return cli::report({Errc::failed, "nendo-bench is not beside nendo; build it with cmake --build "
                                    "--preset release --target nendo-bench, or install the "
                                    "package"});
}

void add(cli::Command& program) {
  cli::Command command = program.add_command(
      "bench", "Measures this program on this machine: latency, faults, load, loop, rings, hands, "
               "calibration, fields, deformation, clay");
  command.set_footer("It starts nendo-bench, which a build without benchmarks does not have.");
}

} // namespace nendo::app::bench_command
