#include "units/cyberglove_three.hpp"

#include <algorithm>

namespace nendo::emulator::unit {
namespace {

// The glove is said to reach 120 records a second over USB.
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
    // One program sends 1E4010111 for 120 records a second: the first digit is the base rate. The
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
