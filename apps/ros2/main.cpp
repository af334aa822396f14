// The nendo-ros2 program.

#include <csignal>
#include <string_view>

#include "cli/cli.hpp"
#include "cli/run_main.hpp"
#include "ros2/ros2_command.hpp"

namespace {

/// Its only command needs no name.
int run(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  nendo::cli::install_stop_signals();
  const std::string_view first = argc > 1 ? argv[1] : "";
  const bool has_name = first == nendo::ros2::command_name || first == "--version";
  return nendo::cli::run_program_with(has_name ? "" : nendo::ros2::command_name, argc, argv,
                                      nendo::ros2::program_summary, nendo::ros2::add_command);
}

} // namespace

int main(int argc, char** argv) {
  return nendo::cli::run_main("nendo-ros2", [&] { return run(argc, argv); });
}
