// An independent host in Python, at the terminal of an emulated FASTRAK.

#include <cstdlib>
#include <string>

#include <doctest/doctest.h>

#include <nendo/emulator/emulator.hpp>

#include "support/pty_host.hpp"

namespace fastrak_host_test {

using nendo::emulator::EmulatorOptions;
using nendo::test::ServedEmulator;

namespace {

EmulatorOptions fastrak(const std::string& motion) {
  EmulatorOptions options;
  options.device = "fastrak";
  options.motion = motion;
  options.tracker.restart_s = 0.8;
  return options;
}

void check_host(const EmulatorOptions& options, const std::string& scenario) {
  const ServedEmulator emulator(options);
  const std::string command =
      "python3 " NENDO_FASTRAK_HOST " " + emulator->tty_path() + " " + scenario;
  CHECK(std::system(command.c_str()) == 0);
}

} // namespace

TEST_SUITE("fastrak_host") {
  TEST_CASE("a Python host reads all items of four stations, in text and binary") {
    EmulatorOptions options = fastrak("orbit");
    options.tracker.stations = {1, 2, 3, 4};
    check_host(options, "orbit");
  }

  TEST_CASE("a Python host changes frames, causes errors and restarts the unit") {
    EmulatorOptions options = fastrak("rest");
    options.faults = {"error@0s=k"};
    check_host(options, "rest");
  }

  TEST_CASE("a Python host sees a receiver that crosses the hemisphere") {
    check_host(fastrak("cross"), "cross");
  }

  TEST_CASE("a Python host sees what a line of 38400 baud drops") {
    EmulatorOptions options = fastrak("orbit");
    options.tracker.baud = 38400;
    check_host(options, "slow");
  }
}

} // namespace fastrak_host_test
