// The nendo-ros2 program.

#include <csignal>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

#include "cli/cli.hpp"
#include "cli/command.hpp"
#include "cli/program_name.hpp"
#include "ros2/ros2_command.hpp"

namespace {

/// Its only command needs no name.
int run(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  nendo::cli::set_program_name("nendo-ros2");
  nendo::cli::install_stop_signals();
  const std::string_view first = argc > 1 ? argv[1] : "";
  std::string command = nendo::ros2::command_name;
  std::vector<char*> arguments(argv, argv + argc);
  if (first != command && first != "--version")
    arguments.insert(arguments.begin() + 1, command.data());
  const auto count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  return nendo::cli::run_program(count, arguments.data(), nendo::ros2::program_summary,
                                 nendo::ros2::add_command);
}

} // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) { // out of memory, mostly
    std::cerr << "nendo-ros2: " << error.what() << '\n';
    return static_cast<int>(nendo::Errc::failed);
  }
}
