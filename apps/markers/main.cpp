// The nendo-markers program.

#include <csignal>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/utility.hpp>

#include <nendo/base/result.hpp>

#include "cli/cli.hpp"
#include "cli/command.hpp"
#include "cli/program_name.hpp"
#include "markers/markers_commands.hpp"

namespace {

/// Without the name of a command, it tracks.
bool names_no_command(int argc, char** argv) {
  if (argc < 2) return true;
  const std::string_view first = argv[1];
  return first.starts_with('-') && first != "-h" && first != "--help" && first != "--version";
}

int run(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  nendo::cli::set_program_name("nendo-markers");
  nendo::cli::install_stop_signals();
  // One processor is enough for 30 pictures per second. The others are the run's.
  cv::setNumThreads(1);
  std::string track = "track";
  std::vector<char*> arguments(argv, argv + argc);
  if (names_no_command(argc, argv)) arguments.insert(arguments.begin() + 1, track.data());
  const auto count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  return nendo::cli::run_program(count, arguments.data(), nendo::markers::program_summary,
                                 nendo::markers::add_commands);
}

} // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) { // out of memory, mostly
    std::cerr << "nendo-markers: " << error.what() << '\n';
    return static_cast<int>(nendo::Errc::failed);
  }
}
