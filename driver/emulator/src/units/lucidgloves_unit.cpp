#include "units/lucidgloves_unit.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

namespace nendo::emulator {
namespace {

constexpr int analog_most = 4095;                    // an ESP32's converter, 12 bits
constexpr std::size_t command_room = 100;            // the firmware's buffer
constexpr double splay_end_rad = from_degrees(20.0); // as OpenGloves shows it

int clamped(double part) {
  return static_cast<int>(std::lround(std::clamp(part, 0.0, 1.0) * analog_most));
}

int curl_of(const driver::JointAngles& angles, Sensor sensor) {
  return clamped(driver::part_of_range(angles, sensor));
}

// Returns the number behind a letter, as the firmware's atoi reads it, or nothing if the letter is
// missing.
std::optional<int> argument(std::string_view command, char letter) {
  const std::size_t at = command.find(letter);
  if (at == std::string_view::npos) return std::nullopt;
  int value = 0;
  std::from_chars(command.data() + at + 1, command.data() + command.size(), value);
  return value;
}

} // namespace

LucidGlovesUnit::LucidGlovesUnit(const LucidGlovesUnitOptions& options)
    : options_(options), period_(std::llround(1e9 / options.rate_hz)),
      motion_(options.motion, options.side, options.seed) {
  assert(options.rate_hz >= 1.0 && options.rate_hz <= most_rate_hz);
}

void LucidGlovesUnit::receive(std::span<const std::byte> bytes, Time now) {
  advance(now);
  for (const std::byte byte : bytes) {
    const char c = std::to_integer<char>(byte);
    if (c == '\n') {
      handle(command_);
      command_.clear();
    } else if (command_.size() < command_room) {
      command_.push_back(c);
    }
  }
}

void LucidGlovesUnit::handle(std::string_view command) {
  if (options_.answers && command == "Z") {
    const std::string answer =
        "(ZV)5(ZG)0(ZH)" + std::to_string(options_.side == Side::right ? 1 : 0) + "\n";
    send(std::as_bytes(std::span(answer)));
    return;
  }
  if (options_.answers && (command == "(ZA)" || command == "(ZZ)")) {
    streaming_ = command == "(ZA)";
    return;
  }
  for (std::size_t finger = 0; finger < brakes_.size(); ++finger) {
    const auto value = argument(command, static_cast<char>('A' + finger));
    if (value && *value >= 0) brakes_[finger] = std::min(*value, 1000);
  }
}

void LucidGlovesUnit::advance(Time now) {
  if (!motion_origin_) {
    motion_origin_ = now;
    next_line_ = now + period_;
  }
  if (streaming_) send_due(next_line_, period_, now, [this](Time due) { return line(due); });
  while (next_line_ <= now) // while it is stopped the grid goes on
    next_line_ += period_;
}

std::optional<EmulatedUnit::Time> LucidGlovesUnit::next_due() const noexcept {
  if (!streaming_) return std::nullopt;
  return next_line_;
}

std::string LucidGlovesUnit::line(Time now) const {
  const auto angles = motion_.at(std::chrono::duration<double>(now - *motion_origin_).count());
  const auto angle_rad = [&](Sensor sensor) { return angles[static_cast<std::size_t>(sensor)]; };
  const std::array curls{curl_of(angles, Sensor::thumb_mcp), curl_of(angles, Sensor::index_mcp),
                         curl_of(angles, Sensor::middle_mcp), curl_of(angles, Sensor::ring_mcp),
                         curl_of(angles, Sensor::pinky_mcp)};
  // The middle finger points straight ahead; its neighbours are as far from it as the motion says.
  const double ring_rad = -angle_rad(Sensor::middle_ring_abduction);
  const std::array splays_rad{angle_rad(Sensor::thumb_abduction) - splay_end_rad,
                              angle_rad(Sensor::index_middle_abduction), 0.0, ring_rad,
                              ring_rad - angle_rad(Sensor::ring_pinky_abduction)};
  std::string text;
  for (std::size_t finger = 0; finger < curls.size(); ++finger)
    text += static_cast<char>('A' + finger) + std::to_string(curls[finger]);
  // Joystick in the middle; the firmware makes the trigger of the index finger's upper half.
  const int trigger = std::max(0, 2 * (curls[1] - analog_most / 2));
  text += "F2048G2048P" + std::to_string(std::min(trigger, analog_most));
  if (*std::min_element(curls.begin(), curls.end()) > analog_most / 2) text += 'L';
  for (std::size_t finger = 0; finger < splays_rad.size(); ++finger) {
    text += std::string("(") + static_cast<char>('A' + finger) + "B)";
    text += std::to_string(clamped(0.5 + 0.5 * splays_rad[finger] / splay_end_rad));
  }
  return text + "\n";
}

std::unique_ptr<EmulatedUnit> make_lucidgloves_unit(const LucidGlovesUnitOptions& options) {
  return std::make_unique<LucidGlovesUnit>(options);
}

} // namespace nendo::emulator
