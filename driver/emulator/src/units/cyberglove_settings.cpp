#include "units/cyberglove_unit.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace nendo::emulator::unit {
namespace {

// On-off settings, and their place in the three bytes of the parameter flags. y is a setting of its
// own, not the text form of Y.
struct Flag {
  Byte letter;
  unsigned parameter_bit;
  bool Settings::* value;
};
constexpr std::array<Flag, 9> flags{{{'W', 1, &Settings::switch_on},
                                     {'L', 2, &Settings::light},
                                     {'Y', 8, &Settings::binary_sync},
                                     {'y', 9, &Settings::text_sync},
                                     {'U', 10, &Settings::status_byte},
                                     {'J', 11, &Settings::switch_drives_light},
                                     {'F', 12, &Settings::filter},
                                     {'D', 13, &Settings::time_stamp},
                                     {'Q', 16, &Settings::quantised}}};

// The counts that the sensors of one wearer were seen to span, slot by slot.
constexpr std::array<Byte, sensor_slots> min_seen{79, 149, 87, 59, 16, 58, 61, 0,  22, 67, 83, 53,
                                                  31, 68,  72, 21, 41, 91, 76, 70, 70, 67, 87, 0};
constexpr std::array<Byte, sensor_slots> max_seen{228, 206, 176, 217, 155, 193, 201, 254,
                                                  177, 168, 165, 162, 174, 176, 175, 159,
                                                  173, 168, 255, 163, 197, 186, 220, 254};
constexpr int whole_gain = 64;

// The slot of the n-th sensor that the glove has.
std::size_t slot_of(const PluggedGlove& glove, std::size_t n) noexcept {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (((glove.mask >> slot) & 1U) != 0 && n-- == 0) return slot;
  }
  return sensor_slots;
}

bool apply_calibration(Settings& settings, const Message& argument, const PluggedGlove& glove) {
  const std::size_t sensors = glove.sensors();
  if (argument[0] == 'A') {
    for (std::size_t n = 0; n < sensors; ++n) {
      const std::size_t slot = slot_of(glove, n);
      settings.offsets[slot] = argument[1 + n];
      settings.gains[slot] = argument[1 + sensors + n];
    }
    return true;
  }
  const std::size_t slot = slot_of(glove, argument[1]);
  if (slot == sensor_slots) return false;
  (argument[0] == 'O' ? settings.offsets : settings.gains)[slot] = argument[2];
  return true;
}

bool apply_vibration(Settings& settings, const Message& argument) {
  if (argument[0] == 0xFF) {
    std::copy(argument.begin() + 1, argument.end(), settings.vibration.begin());
    return true;
  }
  for (std::size_t k = 1; k < argument.size(); k += 2) {
    if (argument[k] >= settings.vibration.size()) return false;
  }
  for (std::size_t k = 1; k < argument.size(); k += 2)
    settings.vibration[argument[k]] = argument[k + 1];
  return true;
}

std::uint16_t word(unsigned first, unsigned second, bool low_first) noexcept {
  return static_cast<std::uint16_t>(low_first ? second << 8U | first : first << 8U | second);
}

// The glove is said to reach 120 records per second over USB.
constexpr unsigned max_frames = 4;
constexpr std::uint64_t frame_ticks = 115200 / 30;

constexpr bool is_sink(Byte letter) noexcept { // USB, Wi-Fi, the SD card
  return letter == 'u' || letter == 'w' || letter == 's';
}

bool set_frames(ThreeSettings& settings, unsigned frames) noexcept {
  if (frames < 1 || frames > max_frames) return false;
  settings.frames = frames;
  return true;
}

} // namespace

std::size_t PluggedGlove::sensors() const noexcept {
  return static_cast<std::size_t>(std::popcount(mask));
}

// The scale of the quantised values is not documented. Chosen: counts above the offset times the
// gain, so that by default the span of a typical wearer fills 1..255.
Byte Settings::quantise(std::size_t slot, Byte count) const noexcept {
  const int scaled = 1 + (count - offsets[slot]) * gains[slot] / whole_gain;
  return static_cast<Byte>(std::clamp(scaled, 1, 255));
}

Settings power_up_settings(double rate_hz, const PluggedGlove& glove) noexcept {
  Settings settings;
  settings.values = static_cast<Byte>(glove.sensors());
  const auto ticks = std::llround(static_cast<double>(tick_hz) / rate_hz);
  settings.period_repeats = ticks > 0xFFFF ? 2 : 1;
  settings.period_ticks = static_cast<std::uint16_t>(ticks / settings.period_repeats);
  settings.offsets = min_seen;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    settings.gains[slot] =
        static_cast<Byte>(std::min(whole_gain * 254 / (max_seen[slot] - min_seen[slot]), 255));
  }
  return settings;
}

std::optional<std::size_t> argument_bytes(Byte letter, const Message& argument,
                                          std::size_t sensors) {
  switch (letter) {
  case 'A':
    if (argument.empty()) return 1;
    if (argument[0] == 0xFF) return 7;
    if (argument[0] > 6) return std::nullopt;
    return 1 + 2 * std::size_t{argument[0]};
  case 'C':
    if (argument.empty()) return 1;
    if (argument[0] == 'A') return 1 + 2 * sensors;
    if (argument[0] == 'O' || argument[0] == 'G') return 3;
    return std::nullopt;
  case 'T':
    return 4;
  case 'M':
  case 'P':
    return 3;
  case 'B':
  case 'D':
  case 'F':
  case 'J':
  case 'L':
  case 'N':
  case 'Q':
  case 'U':
  case 'W':
  case 'Y':
    return 1;
  default:
    return 0;
  }
}

std::size_t number_width(Byte letter) noexcept {
  return letter == 'T' || letter == 'V' ? 2 : 1;
}

bool apply(Settings& settings, Byte letter, const Message& argument, bool period_low_first,
           const PluggedGlove& glove) {
  switch (letter) {
  case 'A':
    return apply_vibration(settings, argument);
  case 'B':
    // The bits that the baud register of the unit's processor has. A pseudo-terminal has no speed.
    settings.baud = argument[0] & 0x37;
    return true;
  case 'C':
    return apply_calibration(settings, argument, glove);
  case 'M':
    settings.mask = from_low_first(argument);
    return true;
  case 'N':
    settings.values = argument[0];
    return true;
  case 'P': {
    const std::uint32_t bits = from_low_first(argument);
    for (const Flag& flag : flags)
      settings.*flag.value = ((bits >> flag.parameter_bit) & 1U) != 0;
    return true;
  }
  case 'T':
    settings.period_ticks = word(argument[0], argument[1], period_low_first);
    settings.period_repeats = word(argument[2], argument[3], period_low_first);
    return true;
  default:
    break;
  }
  for (const Flag& flag : flags) {
    if (flag.letter == letter) settings.*flag.value = argument[0] != 0;
  }
  if (letter == 'W' && settings.switch_drives_light) settings.light = settings.switch_on;
  return true;
}

std::optional<bool> switch_state(const Settings& settings, Byte letter) noexcept {
  for (const Flag& flag : flags) {
    if (flag.letter == letter) return settings.*flag.value;
  }
  return std::nullopt;
}

std::uint32_t writable_parameters(const Settings& settings) noexcept {
  std::uint32_t bits = 0;
  for (const Flag& flag : flags) {
    if (settings.*flag.value) bits |= 1U << flag.parameter_bit;
  }
  return bits;
}

std::uint64_t ThreeSettings::period_ticks() const noexcept {
  return frame_ticks * divider / frames;
}

std::optional<std::size_t> three_bytes(const Message& command) {
  switch (command[0]) {
  case 'S':
    return 1;
  case 'e':
  case 'd':
    if (command.size() > 1 && !is_sink(command[1])) return std::nullopt;
    return 2;
  case 'm':
  case 'u':
  case 'w':
  case 's':
    return 2;
  case 'E':
    return 8;
  default:
    return std::nullopt;
  }
}

bool apply(ThreeSettings& settings, const Message& command) {
  switch (command[0]) {
  case 'e':
  case 'd':
    // There is neither Wi-Fi nor a card here. Their switches are accepted, as are their rates.
    if (command[1] == 'u') settings.usb = command[0] == 'e';
    return true;
  case 'm':
    return set_frames(settings, command[1]);
  case 'u':
    // Only "divider or multiplier" is known. Here it is a divider.
    if (command[1] == 0) return false;
    settings.divider = command[1];
    return true;
  case 'E': {
    // One program sends 1E4010111 for 120 records per second: the first digit is the base rate. The
    // others are believed to switch sinks; as USB works after them, they change nothing here.
    const auto is_digit = [](Byte byte) { return byte >= '0' && byte <= '9'; };
    if (!std::all_of(command.begin() + 1, command.end(), is_digit)) return false;
    return set_frames(settings, static_cast<unsigned>(command[1] - '0'));
  }
  default:
    return true;
  }
}

} // namespace nendo::emulator::unit
