// nendo emulate: emulates the electronics of a data glove or a tracker on a pseudo-terminal, with
// chosen faults.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>
#include <nendo/emulator/emulator.hpp>
#include <nendo/emulator/served_emulator.hpp>

#include "calibrate/practice_hand.hpp"
#include "cli/cli.hpp"
#include "cli/quantities.hpp"
#include "cli/terminal.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::emulate_command {
namespace {

struct Options {
  emulator::EmulatorOptions emulator;
  std::string device;
  std::string glove; ///< the same, by --glove
  std::string hand = "right";
  std::string stations;
  std::optional<double> restart_s;
  std::string glove_option;   ///< the first option that was given and is for gloves only
  std::string tracker_option; ///< the same for trackers
  std::string mask;
  std::string pace = "clock";
  std::string period_order = "msb";
  std::string stamp_bit7 = "on";
  std::string hires_form = "hardware";
  double duration_s = 0.0;
  double hold_s = 0.0;                                 ///< 0: by keys
  std::shared_ptr<calibrate::PracticeHand> practice{}; ///< null: another motion
  std::shared_ptr<cli::Keys> keys{};                   ///< the keys that control it
};

/// The motion that is not in driver::motion_names(), because it needs a hand.
constexpr std::string_view practice_name = "poses";

std::string faults_explained() {
  std::string text = "Faults (--fault, may be repeated; times in s or ms since the start):\n";
  for (const emulator::FaultForm& fault : emulator::fault_forms())
    text += fmt::format("  {:<23} {}\n", fault.form, fault.effect);
  return text + "Example: nendo emulate --link /tmp/glove --fault flip=0.1% --fault unplug@5s+2s";
}

std::string variants_explained() {
  std::string text = "Variants of gloves; the first of each is the default:\n";
  for (const emulator::EmulatedVariant& variant : emulator::emulated_variants())
    text += fmt::format("  {:<35} {}\n",
                        fmt::format("{} --{} {}", variant.glove, variant.option, variant.name),
                        variant.effect);
  return text + "\n";
}

// Returns the mask, or nothing if the text is no mask of 1 to 24 bits.
std::optional<std::uint32_t> parse_mask(std::string_view text) {
  if (text.starts_with("0x")) text.remove_prefix(2);
  const auto mask = number_in<std::uint32_t>(text, 16);
  return mask && *mask != 0 && *mask <= 0xFFFFFF ? mask : std::nullopt;
}

/// With --motion poses, makes the hand that plays the poses of nendo calibrate.
Result<void> practise(Options& options) {
  emulator::EmulatorOptions& emulator = options.emulator;
  const bool poses = emulator.motion == practice_name;
  if (!std::isfinite(options.hold_s) || options.hold_s < 0.0 || options.hold_s > 3600.0 ||
      (options.hold_s > 0.0 && options.hold_s < 3.0))
    return Error{Errc::usage, "--hold: use 3s to 1h; the hand needs up to 2.6 s to reach a pose, "
                              "and `nendo calibrate` needs time to record it"};
  if (options.hold_s > 0.0 && !poses) return Error{Errc::usage, "--hold: needs --motion poses"};
  if (!poses) return {};
  if (emulator.device != "cyberglove")
    return Error{Errc::usage, "--motion poses: needs an emulated cyberglove"};
  constexpr double usual_hold_s = 4.0;
  std::optional<double> hold_s;
  if (options.hold_s > 0.0) hold_s = options.hold_s;
  options.keys = std::make_shared<cli::Keys>();
  if (!hold_s && !options.keys->are_available()) hold_s = usual_hold_s;
  options.practice = std::make_shared<calibrate::PracticeHand>(emulator.seed, hold_s);
  emulator.motion = "rest";
  emulator.cyberglove.played = [practice = options.practice](double time_s) {
    return practice->at(time_s);
  };
  return {};
}

/// Follows the keys of the terminal for 20 ms at most, and prints what the hand does, if that is
/// not `shown`. Returns false if the user quits.
bool follow_keys(const Options& options, int& shown) {
  constexpr std::chrono::milliseconds time(20);
  if (options.practice == nullptr) {
    std::this_thread::sleep_for(time);
    return true;
  }
  const auto key = options.keys->next(time);
  if (key == ' ') options.practice->go_on();
  if (key == 'b') options.practice->go_back();
  if (const int step = options.practice->step(); std::exchange(shown, step) != step)
    std::cout << options.practice->in_words(step) << std::endl;
  return key != 'q';
}

/// Returns the type of a device; of an unknown one that of the options that were given with it, so
/// that its name is what is refused.
emulator::DeviceType type_of(const Options& options) {
  const auto devices = emulator::emulated_devices();
  const auto found = std::find_if(devices.begin(), devices.end(), [&](const auto& device) {
    return device.name == options.emulator.device;
  });
  if (found != devices.end()) return found->type;
  return options.tracker_option.empty() ? emulator::DeviceType::glove
                                        : emulator::DeviceType::tracker;
}

/// Chooses the device, and refuses options that it does not have.
Result<void> choose_device(Options& options) {
  if (!options.device.empty() && !options.glove.empty() && options.device != options.glove)
    return Error{Errc::usage, "--glove " + options.glove + ": the device is " + options.device +
                                  " already; leave one of them out"};
  std::string& device = options.emulator.device;
  if (!options.glove.empty()) device = options.glove;
  if (!options.device.empty()) device = options.device;
  const bool is_tracker = type_of(options) == emulator::DeviceType::tracker;
  const std::string& foreign = is_tracker ? options.glove_option : options.tracker_option;
  if (foreign.empty()) return {};
  return Error{Errc::usage, foreign + ": it is for " + (is_tracker ? "gloves" : "trackers") +
                                ", and the device is a " + device + "; leave it out"};
}

Result<void> choose_stations(Options& options) {
  if (options.stations.empty()) return {};
  options.emulator.tracker.stations.clear();
  for (ItemReader items(options.stations, ','); !items.has_ended();) {
    const auto station = number_in<unsigned>(items.next());
    if (!station)
      return Error{Errc::usage, "--stations " + options.stations +
                                    ": use numbers with commas between, such as 1,2"};
    options.emulator.tracker.stations.push_back(*station);
  }
  return {};
}

Result<void> complete(Options& options) {
  if (auto chosen = choose_device(options); !chosen) return chosen;
  if (auto chosen = choose_stations(options); !chosen) return chosen;
  if (options.restart_s)
    options.emulator.cyberglove.restart_s = options.emulator.tracker.restart_s = *options.restart_s;
  const auto side = side_named(options.hand);
  if (!side) return Error{Errc::usage, "--hand " + options.hand + ": use left or right"};
  if (auto fine = cli::check_duration(options.duration_s); !fine) return fine;
  emulator::EmulatorOptions& emulator = options.emulator;
  emulator.side = *side;
  emulator.pace =
      options.pace == "host" ? emulator::EmulatorPace::host : emulator::EmulatorPace::clock;
  emulator.cyberglove.period_low_first = options.period_order == "lsb";
  emulator.cyberglove.stamp_bit7 = options.stamp_bit7 == "on";
  emulator.cyberglove.hires_terminated = options.hires_form == "terminated";
  if (const auto made = practise(options); !made) return made;
  if (options.mask.empty()) return {};
  const auto mask = parse_mask(options.mask);
  if (!mask) {
    return Error{Errc::usage, "--mask " + options.mask +
                                  ": use up to 24 bits in hexadecimal, e.g. 7fff7f for 22 sensors"};
  }
  emulator.cyberglove.hardware_mask = *mask;
  return {};
}

void print(const emulator::EmulatorStats& stats) {
  std::cout << stats.records_sent << " records sent, " << stats.bytes_received
            << " bytes received from the host\n";
  if (stats.bytes_refused > 0) {
    std::cout << stats.bytes_refused << " bytes were not sent, because no host read them\n";
  }
  if (stats.faults.empty()) return;
  std::cout << "faults:";
  for (const emulator::FaultCount& fault : stats.faults)
    std::cout << ' ' << fault.name << ' ' << fault.done << ',';
  std::cout << " in " << stats.records_faulted << " records\n";
}

int emulate(Options& options) {
  if (const auto completed = complete(options); !completed) return cli::report(completed.error());
  const auto emulator = emulator::DeviceEmulator::open(options.emulator);
  if (!emulator) return cli::report(emulator.error());

  cli::install_stop_signals();
  const bool is_glove = type_of(options) == emulator::DeviceType::glove;
  std::cout << "emulating a " << (is_glove ? options.hand + "-hand " : "")
            << options.emulator.device << " at "
            << (options.emulator.link.empty() ? (*emulator)->tty_path() : options.emulator.link)
            << "; Ctrl-C ends it" << std::endl;

  emulator::ServedEmulator server(**emulator);
  const auto start = std::chrono::steady_clock::now();
  const std::chrono::duration<double> duration(options.duration_s);
  if (options.keys && options.keys->are_available())
    std::cout << "SPACE: next pose   b: previous pose   q: quit" << std::endl;
  int shown = -1; // the step that was printed
  while (!cli::stop_requested() && !server.is_over() && follow_keys(options, shown)) {
    if (options.duration_s > 0.0 && std::chrono::steady_clock::now() - start >= duration) break;
  }
  const auto served = server.finish();
  if (options.keys) options.keys->restore();
  print((*emulator)->stats());
  return served ? 0 : cli::report(served.error());
}

std::string device_names() {
  std::vector<std::string_view> names;
  for (const emulator::EmulatedDevice& device : emulator::emulated_devices())
    names.push_back(device.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

void add_device_options(cli::Command command, Options& options) {
  emulator::EmulatorOptions& emulator = options.emulator;
  command.add_option(
      "--motion", emulator.motion,
      fmt::format("What the hand does, by default sculpt: {}, or poses: those of "
                  "nendo calibrate, in its order; in front of a tracker, by default orbit: {}",
                  fmt::join(emulator::emulated_motions(emulator::DeviceType::glove), ", "),
                  fmt::join(emulator::emulated_motions(emulator::DeviceType::tracker), ", ")));
  command.add_option("--seed", emulator.seed, "Seed of motion, noise and faults");
  command.add_option("--pace", options.pace, "clock: as a device; host: as fast as the host reads")
      .one_of({"clock", "host"});
  command.add_duration(
      "--restart-time", options.restart_s,
      "Duration of a restart of its firmware. CyberGlove: 0.2s, which the maker's library expects "
      "(default), or 1.75s as in the manual; tracker: 10s");
}

void add_tracker_options(cli::Command command, Options& options) {
  emulator::EmulatedTracker& tracker = options.emulator.tracker;
  command.add_option("--stations", options.stations,
                     "The stations that have receivers; 1,2 by default");
  command.add_flag(
      "--noise", tracker.noise,
      "Its own noise, of a FASTRAK 0.8 mm and 0.15 degrees RMS, instead of exact poses");
  command.add_option("--baud", tracker.baud,
                     "The rate of its serial line; a host at another rate receives garbage");
}

void add_glove_options(cli::Command command, Options& options) {
  emulator::EmulatorOptions& emulator = options.emulator;
  command.add_option("--firmware", emulator.firmware, "Its firmware, see below");
  command.add_option("--connection", emulator.connection, "Its connection, see below");
  command.add_option("--hand", options.hand, "left or right");
  command.add_option("--sensors", emulator.sensors,
                     "Number of sensors; a CyberGlove has 22 (default) or 18");
  command.add_duration(
      "--hold", options.hold_s,
      "With --motion poses: how long each pose is held, after a free motion of 8 s, "
      "repeatedly; without it, SPACE advances to the next pose, or without a keyboard "
      "4 s");
  command.add_rate("--rate", emulator.rate_hz,
                   "Records per second until the host sets another rate");
}

void add_cyberglove_options(cli::Command command, Options& options) {
  emulator::EmulatedCyberGlove& glove = options.emulator.cyberglove;
  command.add_option("--model", glove.model, "1, 2 or 3");
  command.add_option("--mask", options.mask, "The sensors it has, in hexadecimal, e.g. 6b3b3f");
  command.add_flag("--touch", glove.touch, "It has the vibrators of a CyberTouch");
  command.add_option("--reply-bytes", glove.reply_bytes,
                     "Bytes of the reply to a setting: 2, or 3 as one library expects");
  command
      .add_option("--period-order", options.period_order,
                  "Byte order of the words of T: msb or lsb first")
      .one_of({"msb", "lsb"});
  command
      .add_option("--stamp-bit7", options.stamp_bit7,
                  "Bit 7 of a time stamp's first byte: on: always set; off: set only if needed")
      .one_of({"on", "off"});
  command
      .add_option("--hires-form", options.hires_form,
                  "Replies of a III. hardware: it echoes 1S, and the 0x03 that ends its stream, "
                  "without NUL, and counts sub-frames from 0; terminated: with NUL, and from 1")
      .one_of({"hardware", "terminated"});
  command.add_flag("--overrun", glove.overrun,
                   "Its first period is too short: each record of a stream reports es");
  command.add_flag("--streaming", glove.streaming,
                   "It streams at the start, as after a crash of the host");
  command.add_flag("--pattern", glove.pattern,
                   "No motion: in record n, slot k counts 1 + (n + 29 k) mod 255");
  command.add_option("--replay", glove.replay,
                     "Send the records of this file of received bytes, repeatedly");
}

} // namespace
} // namespace nendo::app::emulate_command

void nendo::app::add_emulate(cli::Command& program) {
  using namespace emulate_command;
  cli::Command command = program.add_command(
      "emulate", "Emulates the electronics of a glove or tracker on a pseudo-terminal, for tests");
  Options& options = command.on_chosen<Options>([command](Options& given) {
    given.glove_option = command.first_given(
        {"--firmware", "--connection", "--hand", "--sensors", "--hold", "--rate", "--model",
         "--mask", "--touch", "--reply-bytes", "--period-order", "--stamp-bit7", "--hires-form",
         "--overrun", "--streaming", "--pattern", "--replay"});
    given.tracker_option = command.first_given({"--stations", "--noise", "--baud"});
    return emulate(given);
  });
  command.add_option("DEVICE", options.device, device_names() + "; a cyberglove by default");
  command.add_option("--glove", options.glove, "The same as DEVICE");
  command
      .add_option("--link", options.emulator.link,
                  "Symbolic link to make to the pseudo-terminal, e.g. /tmp/glove")
      .required();
  command.add_duration("--duration", options.duration_s,
                       "How long, e.g. 30s or 10m; 0: until Ctrl-C");
  command.add_option("--fault", options.emulator.faults, "A fault, see below").once_each("FAULT");
  command.add_option("--log", options.emulator.log,
                     "Write all traffic to this file, one line per message");
  add_device_options(command.under("The device"), options);
  add_glove_options(command.under("Gloves only"), options);
  add_tracker_options(command.under("Trackers only"), options);
  add_cyberglove_options(command.under("CyberGlove only"), options);
  command.set_footer(variants_explained() + faults_explained());
}
