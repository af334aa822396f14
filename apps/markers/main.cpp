// The nendo-markers program.

#include <csignal>
#include <string_view>

#include <opencv2/core/utility.hpp>

#include "cli/cli.hpp"
#include "cli/run_main.hpp"
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
  nendo::cli::install_stop_signals();
  // One processor is enough for 30 pictures per second. The others are the run's.
  cv::setNumThreads(1);
  return nendo::cli::run_program_with(names_no_command(argc, argv) ? "track" : "", argc, argv,
                                      nendo::markers::program_summary,
                                      nendo::markers::add_commands);
}

} // namespace

int main(int argc, char** argv) {
  return nendo::cli::run_main("nendo-markers", [&] { return run(argc, argv); });
}
