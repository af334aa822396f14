// The table of the devices that can be emulated, and of the gloves' variants.

#include "units/emulated_kinds.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <string>
#include <utility>

#include <nendo/driver/simulated_glove.hpp>

#include "units/capture.hpp"
#include "units/cyberglove_unit.hpp"
#include "units/emulated_unit.hpp"
#include "units/fastrak_unit.hpp"
#include "units/fivedt_unit.hpp"
#include "units/flock_unit.hpp"
#include "units/forte_unit.hpp"
#include "units/lucidgloves_unit.hpp"

namespace nendo::emulator {
namespace {

// The first variant of each glove and option is the default. Their order is that of the units'
// enums.
constexpr std::array variants{
    EmulatedVariant{"lucidgloves", "firmware", "senseshift",
                    "answers questions, stops by command, takes brakes"},
    EmulatedVariant{"lucidgloves", "firmware", "streaming",
                    "LucidGloves without force feedback: hears nothing"},
    EmulatedVariant{"lucidgloves", "firmware", "waiting",
                    "LucidGloves: waits up to 1 s for a line after each of its own"},
    EmulatedVariant{"lucidgloves", "firmware", "legacy",
                    "13 numbers a line, and any line that it hears sets its brakes"},
    EmulatedVariant{"lucidgloves", "firmware", "legacy-waiting",
                    "the same, and waits up to 5 s for a line after each of its own"},
    EmulatedVariant{"lucidgloves", "firmware", "unclamped",
                    "as streaming; numbers go beyond the range, and below 0"},
    EmulatedVariant{"lucidgloves", "firmware", "legacy-unclamped",
                    "as legacy; numbers go beyond the range, and below 0"},
    EmulatedVariant{"5dt", "firmware", "thumb-first", "a sample begins with the thumb"},
    EmulatedVariant{"5dt", "firmware", "little-first",
                    "a left glove's sample begins with the little finger"},
    EmulatedVariant{"5dt", "connection", "wired", "answers, and streams by command"},
    EmulatedVariant{"5dt", "connection", "wireless", "streams by itself, and hears nothing"},
    EmulatedVariant{"forte", "connection", "usb", "sends after the command to use USB"},
    EmulatedVariant{"flock", "firmware", "bird", "the first box has the transmitter and a bird"},
    EmulatedVariant{"flock", "firmware", "erc",
                    "the first box is an extended range controller; birds follow"},
    EmulatedVariant{"forte", "connection", "bluetooth", "sends after the command to use Bluetooth"},
};

/// Returns the place of `chosen` among the variants of this option. An empty one is the first.
Result<std::size_t> find_variant(const std::string& glove, std::string_view option,
                                 const std::string& chosen) {
  std::string names;
  std::size_t place = 0;
  for (const EmulatedVariant& variant : variants) {
    if (variant.glove != glove || variant.option != option) continue;
    if (chosen.empty() || variant.name == chosen) return place;
    names.append(names.empty() ? "" : ", ").append(variant.name);
    ++place;
  }
  if (chosen.empty()) return place;
  return Error{Errc::usage, std::string(option) + " " + chosen + ": an emulated " + glove +
                                (names.empty() ? " has no choice of it" : " has one of " + names)};
}

Result<driver::Motion> find_hand_motion(const std::string& name) {
  return driver::find_motion(name.empty() ? "sculpt" : name);
}

/// The places of the chosen variants.
struct Chosen {
  std::size_t firmware = 0;
  std::size_t connection = 0;
};
Result<Chosen> find_variants(const EmulatorOptions& options) {
  const auto firmware = find_variant(options.device, "firmware", options.firmware);
  if (!firmware) return firmware.error();
  const auto connection = find_variant(options.device, "connection", options.connection);
  if (!connection) return connection.error();
  return Chosen{*firmware, *connection};
}

// Each sets up a unit as the chosen variants want it, and returns its max records per
// second.
double choose(const Chosen& chosen, LucidGlovesUnitOptions& unit) {
  unit.firmware = static_cast<LucidGlovesFirmware>(chosen.firmware);
  return LucidGlovesUnit::max_rate_hz;
}
double choose(const Chosen& chosen, FiveDtUnitOptions& unit) {
  unit.left_little_first = chosen.firmware == 1;
  unit.wireless = chosen.connection == 1;
  return unit.wireless ? FiveDtUnit::max_wireless_rate_hz : FiveDtUnit::max_rate_hz;
}
double choose(const Chosen& chosen, ForteUnitOptions& unit) {
  unit.bluetooth = chosen.connection == 1;
  return ForteUnit::max_rate_hz;
}

/// Makes a unit of the options that every kind has.
template <class Unit, class UnitOptions>
Result<std::unique_ptr<EmulatedUnit>> make_unit(const EmulatorOptions& options) {
  const auto motion = find_hand_motion(options.motion);
  if (!motion) return motion.error();
  const auto chosen = find_variants(options);
  if (!chosen) return chosen.error();
  UnitOptions unit;
  const double max_rate_hz = choose(*chosen, unit);
  if (!(options.rate_hz >= 1.0 && options.rate_hz <= max_rate_hz)) {
    return Error{Errc::usage, "rate: a " + options.device + " glove sends 1 to " +
                                  std::to_string(static_cast<int>(max_rate_hz)) +
                                  " records per second"};
  }
  unit.side = options.side;
  unit.motion = *motion;
  unit.rate_hz = options.rate_hz;
  unit.seed = options.seed;
  return std::unique_ptr<EmulatedUnit>(std::make_unique<Unit>(unit));
}

Error usage(const std::string& what) {
  return {Errc::usage, what};
}

Result<void> check_cyberglove(const EmulatorOptions& options) {
  const EmulatedCyberGlove& special = options.cyberglove;
  if (options.sensors != 0 && options.sensors != 18 && options.sensors != 22) {
    return usage("sensors " + std::to_string(options.sensors) +
                 ": a CyberGlove has 18 or 22; give older ones by their mask");
  }
  if (special.hardware_mask > 0xFFFFFF) {
    return usage("mask: it has 24 bits, e.g. 7fff7f for 22 sensors");
  }
  if (options.sensors != 0 && special.hardware_mask != 0 &&
      std::popcount(special.hardware_mask) != static_cast<int>(options.sensors)) {
    return usage("sensors " + std::to_string(options.sensors) + ": the mask has " +
                 std::to_string(std::popcount(special.hardware_mask)) + "; leave one of them out");
  }
  if (special.model < 1 || special.model > 3) {
    return usage("model " + std::to_string(special.model) + ": use 1, 2 or 3");
  }
  if (special.reply_bytes != 2 && special.reply_bytes != 3) {
    return usage("reply-bytes " + std::to_string(special.reply_bytes) + ": use 2 or 3");
  }
  if (!(special.restart_s >= 0.0 && special.restart_s <= 60.0)) {
    return usage("restart-time: use 0s to 60s");
  }
  if (!(options.rate_hz >= 1.0 && options.rate_hz <= CyberGloveUnit::max_rate_hz)) {
    return usage("rate: use 1 to 480 records per second (what 115200 baud can carry)");
  }
  return {};
}

/// A CyberGlove's variants are options of its own.
Result<std::unique_ptr<EmulatedUnit>> make_cyberglove(const EmulatorOptions& options) {
  if (const auto chosen = find_variants(options); !chosen) return chosen.error();
  if (auto checked = check_cyberglove(options); !checked) return checked.error();
  const auto motion = find_hand_motion(options.motion);
  if (!motion) return motion.error();
  UnitOptions unit{options.cyberglove,
                   options.side,
                   options.sensors == 18 ? 18U : 22U,
                   *motion,
                   options.rate_hz,
                   options.seed,
                   {}};
  if (!unit.replay.empty()) {
    auto capture = read_capture(unit.replay);
    if (!capture) return capture.error();
    unit.capture = *std::move(capture);
  }
  return std::unique_ptr<EmulatedUnit>(std::make_unique<CyberGloveUnit>(unit));
}

Result<std::unique_ptr<EmulatedUnit>> make_fastrak(const EmulatorOptions& options) {
  if (const auto chosen = find_variants(options); !chosen) return chosen.error();
  const auto motion = driver::find_wrist_motion(options.motion.empty() ? "orbit" : options.motion);
  if (!motion) return motion.error();
  const EmulatedTracker& tracker = options.tracker;
  fastrak::FastrakUnitOptions unit;
  unit.plugged.fill(false);
  for (const unsigned station : tracker.stations) {
    if (station < 1 || station > fastrak::max_stations)
      return usage("stations: a FASTRAK has the stations 1 to 4");
    unit.plugged[station - 1] = true;
  }
  constexpr std::array<unsigned, 7> rates{2400, 4800, 9600, 19200, 38400, 57600, 115200};
  if (std::find(rates.begin(), rates.end(), tracker.baud) == rates.end())
    return usage("baud: use 2400, 4800, 9600, 19200, 38400, 57600 or 115200");
  if (!(tracker.restart_s >= 0.0 && tracker.restart_s <= 60.0))
    return usage("restart-time: use 0s to 60s");
  unit.motion = *motion;
  unit.seed = options.seed;
  unit.noise = tracker.noise;
  unit.baud = tracker.baud;
  unit.restart_s = tracker.restart_s;
  return std::unique_ptr<EmulatedUnit>(std::make_unique<fastrak::FastrakUnit>(unit));
}

Result<std::unique_ptr<EmulatedUnit>> make_flock(const EmulatorOptions& options) {
  const auto chosen = find_variants(options);
  if (!chosen) return chosen.error();
  const auto motion = driver::find_wrist_motion(options.motion.empty() ? "orbit" : options.motion);
  if (!motion) return motion.error();
  const EmulatedTracker& tracker = options.tracker;
  flock::FlockUnitOptions unit;
  unit.has_controller = chosen->firmware == 1;
  unit.birds = tracker.stations;
  const unsigned first = unit.has_controller ? 2 : 1;
  for (const unsigned station : tracker.stations)
    if (station < first || station > flock::max_units)
      return usage("stations: birds of this flock have the addresses " + std::to_string(first) +
                   " to 14");
  constexpr std::array<unsigned, 7> rates{2400, 4800, 9600, 19200, 38400, 57600, 115200};
  if (std::find(rates.begin(), rates.end(), tracker.baud) == rates.end())
    return usage("baud: use 2400, 4800, 9600, 19200, 38400, 57600 or 115200");
  unit.motion = *motion;
  unit.seed = options.seed;
  unit.noise = tracker.noise;
  unit.baud = tracker.baud;
  return std::unique_ptr<EmulatedUnit>(std::make_unique<flock::FlockUnit>(unit));
}

using Happens = Incident::Kind;
constexpr IncidentSet cyberglove_incidents{
    Happens::glove_out,  Happens::glove_in,     Happens::power_cycle, Happens::switch_on,
    Happens::switch_off, Happens::sensor_stuck, Happens::sensor_free};
constexpr IncidentSet fastrak_incidents{Happens::glove_out,   Happens::glove_in,
                                        Happens::power_cycle, Happens::switch_on,
                                        Happens::switch_off,  Happens::tracker_error};

constexpr IncidentSet flock_incidents{Happens::power_cycle};

constexpr std::array kinds{
    EmulatedKind{"cyberglove", DeviceType::glove, make_cyberglove, cyberglove_incidents},
    EmulatedKind{
        "lucidgloves", DeviceType::glove, make_unit<LucidGlovesUnit, LucidGlovesUnitOptions>, {}},
    EmulatedKind{"5dt", DeviceType::glove, make_unit<FiveDtUnit, FiveDtUnitOptions>, {}},
    EmulatedKind{"forte", DeviceType::glove, make_unit<ForteUnit, ForteUnitOptions>, {}},
    EmulatedKind{"fastrak", DeviceType::tracker, make_fastrak, fastrak_incidents},
    EmulatedKind{"flock", DeviceType::tracker, make_flock, flock_incidents},
};

} // namespace

std::vector<EmulatedDevice> emulated_devices() {
  std::vector<EmulatedDevice> devices;
  for (const EmulatedKind& kind : kinds)
    devices.push_back({kind.name, kind.type});
  return devices;
}

std::vector<std::string_view> emulated_motions(DeviceType type) {
  return type == DeviceType::glove ? driver::motion_names() : driver::wrist_motion_names();
}

std::vector<EmulatedVariant> emulated_variants() {
  return {variants.begin(), variants.end()};
}

Result<EmulatedKind> find_emulated_kind(std::string_view name) {
  std::string names;
  for (const EmulatedKind& kind : kinds) {
    if (kind.name == name) return kind;
    names.append(names.empty() ? "" : ", ").append(kind.name);
  }
  return Error{Errc::usage,
               "device \"" + std::string(name) + "\" cannot be emulated; there is " + names};
}

} // namespace nendo::emulator
