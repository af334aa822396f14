#include "units/lucidgloves_unit.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

namespace nendo::emulator {
namespace {

constexpr int analog_max = 4095;              // an ESP32's converter, 12 bits
constexpr std::size_t command_capacity = 100; // the firmware's buffer
constexpr std::size_t min_command = 5;        // shorter lines are ignored
constexpr std::size_t line_capacity = 256;    // an ESP32's receive buffer
constexpr int max_brake = 1000;
constexpr double splay_end_rad = from_degrees(20.0); // as OpenGloves shows it

// What a calibration that saw less than the whole way makes of it.
constexpr double seen_from = 0.25;
constexpr double seen_part = 0.35;

// Returns the number after a letter, as the firmware's atoi reads it, or nothing if the letter is
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
  assert(options.rate_hz >= 1.0 && options.rate_hz <= max_rate_hz);
}

bool LucidGlovesUnit::is_legacy() const noexcept {
  return options_.firmware == LucidGlovesFirmware::legacy ||
         options_.firmware == LucidGlovesFirmware::legacy_waiting ||
         options_.firmware == LucidGlovesFirmware::legacy_unclamped;
}

bool LucidGlovesUnit::is_unclamped() const noexcept {
  return options_.firmware == LucidGlovesFirmware::unclamped ||
         options_.firmware == LucidGlovesFirmware::legacy_unclamped;
}

bool LucidGlovesUnit::is_deaf() const noexcept {
  return options_.firmware == LucidGlovesFirmware::streaming ||
         options_.firmware == LucidGlovesFirmware::unclamped;
}

// `part` of the way from one end to the other, as the firmware sends it.
int LucidGlovesUnit::number(double part) const {
  if (is_unclamped())
    return static_cast<int>(std::lround((part - seen_from) / seen_part * analog_max));
  return static_cast<int>(std::lround(std::clamp(part, 0.0, 1.0) * analog_max));
}

void LucidGlovesUnit::receive(std::span<const std::byte> bytes, Time now) {
  advance(now);
  if (is_deaf()) return;
  if (!bytes.empty()) last_heard_ = now;
  for (const std::byte byte : bytes) {
    const char c = std::to_integer<char>(byte);
    if (waits()) {
      if (heard_.size() < line_capacity) heard_.push_back(c);
    } else if (c == '\n') {
      handle(heard_);
      heard_.clear();
    } else if (heard_.size() < command_capacity) {
      heard_.push_back(c);
    }
  }
  if (waits()) advance_loop(now);
}

void LucidGlovesUnit::handle(std::string_view command) {
  const bool answers = options_.firmware == LucidGlovesFirmware::senseshift;
  if (is_legacy()) return set_legacy_brakes(command);
  if (answers && command == "Z") {
    const std::string answer =
        "(ZV)5(ZG)0(ZH)" + std::to_string(options_.side == Side::right ? 1 : 0) + "\n";
    send(std::as_bytes(std::span(answer)));
    return;
  }
  if (answers && (command == "(ZA)" || command == "(ZZ)")) {
    streaming_ = command == "(ZA)";
    return;
  }
  if (waits() && command.size() < min_command) return;
  for (std::size_t finger = 0; finger < brakes_.size(); ++finger) {
    const auto value = argument(command, static_cast<char>('A' + finger));
    if (value && *value >= 0) brakes_[finger] = std::min(*value, max_brake);
  }
}

// Old versions have no least length, and leave the brakes that a line does not name undefined: here
// these lock, which is the worst.
void LucidGlovesUnit::set_legacy_brakes(std::string_view command) {
  if (command.empty()) return;
  brakes_.fill(max_brake);
  for (int& brake : brakes_) {
    const std::size_t end = std::min(command.find('&'), command.size());
    int value = 0; // what atoi makes of text
    std::from_chars(command.data(), command.data() + end, value);
    brake = std::clamp(value, 0, max_brake);
    if (end == command.size()) return;
    command.remove_prefix(end + 1);
  }
}

void LucidGlovesUnit::advance(Time now) {
  if (!motion_origin_) {
    motion_origin_ = now;
    next_line_ = now + (waits() ? loop_time : period_);
  }
  if (waits()) return advance_loop(now);
  if (streaming_) send_due(next_line_, period_, now, [this](Time due) { return line(due); });
  while (next_line_ <= now) // while it is stopped the grid continues
    next_line_ += period_;
}

// The firmware's loop: it sends a line, and then reads one, for which it waits.
void LucidGlovesUnit::advance_loop(Time now) {
  for (;;) {
    if (!waits_since_) {
      if (next_line_ > now) return;
      const std::string text = line(next_line_);
      send_record(std::as_bytes(std::span(text)));
      waits_since_ = next_line_;
    }
    const auto heard = take_line(now);
    if (!heard) return;
    handle(heard->line);
    next_line_ = heard->at + loop_time;
    waits_since_.reset();
  }
}

// Returns the line that ends the wait, without its LF: a whole one, as much of one as the buffer
// takes, or what there is when the time is up. Nothing: the wait continues.
std::optional<LucidGlovesUnit::Heard> LucidGlovesUnit::take_line(Time now) {
  const std::size_t end = heard_.find('\n');
  const bool whole = end < command_capacity || heard_.size() >= command_capacity;
  // A line that came while the last one was handled was there when the wait began.
  const Time since = std::max(*waits_since_, last_heard_);
  if (!whole && now - since < max_wait()) return std::nullopt;
  const std::size_t length = std::min({end, heard_.size(), command_capacity});
  Heard heard{heard_.substr(0, length), whole ? since : since + max_wait()};
  heard_.erase(0, length + (end == length && end < command_capacity ? 1 : 0));
  return heard;
}

std::optional<EmulatedUnit::Time> LucidGlovesUnit::next_due() const noexcept {
  if (waits_since_) return std::max(*waits_since_, last_heard_) + max_wait();
  if (!streaming_) return std::nullopt;
  return next_line_;
}

std::string LucidGlovesUnit::line(Time now) const {
  const auto angles = motion_.at(std::chrono::duration<double>(now - *motion_origin_).count());
  const auto angle_rad = [&](Sensor sensor) { return angles[static_cast<std::size_t>(sensor)]; };
  const auto curl_of = [&](Sensor sensor) { return number(driver::part_of_range(angles, sensor)); };
  const std::array curls{curl_of(Sensor::thumb_mcp), curl_of(Sensor::index_mcp),
                         curl_of(Sensor::middle_mcp), curl_of(Sensor::ring_mcp),
                         curl_of(Sensor::little_mcp)};
  if (is_legacy()) return legacy_line(curls);
  // The middle finger points straight ahead; its neighbours are as far from it as the motion says.
  const double ring_rad = -angle_rad(Sensor::middle_ring_abduction);
  const std::array splays_rad{angle_rad(Sensor::thumb_abduction) - splay_end_rad,
                              angle_rad(Sensor::index_middle_abduction), 0.0, ring_rad,
                              ring_rad - angle_rad(Sensor::ring_little_abduction)};
  std::string text;
  for (std::size_t finger = 0; finger < curls.size(); ++finger)
    text += static_cast<char>('A' + finger) + std::to_string(curls[finger]);
  // Joystick in the middle; the firmware makes the trigger of the index finger's upper half.
  const int trigger = std::max(0, 2 * (curls[1] - analog_max / 2));
  text += "F2048G2048P" + std::to_string(std::min(trigger, analog_max));
  if (*std::min_element(curls.begin(), curls.end()) > analog_max / 2) text += 'L';
  for (std::size_t finger = 0; finger < splays_rad.size(); ++finger) {
    text += std::string("(") + static_cast<char>('A' + finger) + "B)";
    text += std::to_string(number(0.5 + 0.5 * splays_rad[finger] / splay_end_rad));
  }
  return text + "\n";
}

// The curls, the joystick in the middle, and six buttons that are not pressed.
std::string LucidGlovesUnit::legacy_line(const std::array<int, 5>& curls) const {
  std::string text;
  for (const int curl : curls)
    text += std::to_string(curl) + "&";
  return text + "2048&2048&0&0&0&0&0&0\n";
}

} // namespace nendo::emulator
