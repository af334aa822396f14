// nendo emulate: a CyberGlove interface unit on a pseudo-terminal.

#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <thread>

#include <nendo/driver/emulator.hpp>

#include "cli.hpp"

namespace nendo::app {
namespace {

struct Options {
  driver::EmulatorOptions emulator;
  std::string hand = "right";
  double duration_s = 0.0;
};

std::string known_motions() {
  std::string list;
  for (const auto name : driver::motion_names())
    list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

int emulate(Options& options) {
  if (options.hand != "left" && options.hand != "right") {
    return report({Errc::usage, "--hand " + options.hand + ": use left or right"});
  }
  if (!std::isfinite(options.duration_s) || options.duration_s < 0.0) {
    return report({Errc::usage, "--duration: use a number of seconds, 0 for no end"});
  }
  options.emulator.side = options.hand == "left" ? Side::left : Side::right;
  const auto emulator = driver::GloveEmulator::open(options.emulator);
  if (!emulator) return report(emulator.error());

  install_stop_signals();
  std::cout << "emulating a " << options.emulator.sensors << "-sensor " << options.hand
            << "-hand CyberGlove at "
            << (options.emulator.link.empty() ? (*emulator)->tty_path() : options.emulator.link)
            << "; Ctrl-C ends it" << std::endl;

  std::atomic<bool> over{false};
  Result<void> served;
  std::thread server([&] {
    served = (*emulator)->serve(over);
    over = true; // an emulator that fails must not be waited for
  });
  const auto start = std::chrono::steady_clock::now();
  const std::chrono::duration<double> duration(options.duration_s);
  while (!stop_requested() && !over) {
    if (options.duration_s > 0.0 && std::chrono::steady_clock::now() - start >= duration) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  over = true;
  server.join();
  if (!served) return report(served.error());
  const auto stats = (*emulator)->stats();
  std::cout << stats.records_sent << " records sent, " << stats.bytes_received
            << " bytes received from the host\n";
  return 0;
}

} // namespace

void add_emulate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App& command = *app.add_subcommand(
      "emulate", "Emulates a CyberGlove interface unit on a pseudo-terminal, to test with");
  command
      .add_option("--link", options->emulator.link,
                  "Symbolic link to make to the pseudo-terminal, e.g. /tmp/glove")
      ->required();
  command.add_option("--sensors", options->emulator.sensors, "18 or 22")->capture_default_str();
  command.add_option("--hand", options->hand, "left or right")->capture_default_str();
  command.add_option("--motion", options->emulator.motion, known_motions())->capture_default_str();
  command
      .add_option("--rate", options->emulator.rate_hz,
                  "Records a second until the host sets its own")
      ->capture_default_str();
  command.add_option("--seed", options->emulator.seed, "Varies the motion and the noise")
      ->capture_default_str();
  command.add_option("--duration", options->duration_s, "Seconds to run; without it, until Ctrl-C");
  on_chosen(command, exit_code, [options] { return emulate(*options); });
}

} // namespace nendo::app
