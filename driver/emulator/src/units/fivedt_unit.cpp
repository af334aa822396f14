#include "units/fivedt_unit.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string_view>

namespace nendo::emulator {
namespace {

constexpr std::array flexions{Sensor::thumb_mcp, Sensor::index_mcp, Sensor::middle_mcp,
                              Sensor::ring_mcp, Sensor::little_mcp};
constexpr std::uint8_t acknowledge = 0x55;
constexpr std::uint8_t level = 0x7F; // the hand is held level: the middle of a tilt sensor's range

std::uint8_t flexion_count(const driver::JointAngles& angles, Sensor sensor) {
  return static_cast<std::uint8_t>(std::lround(driver::part_of_range(angles, sensor) * 255.0));
}

} // namespace

FiveDtUnit::FiveDtUnit(const FiveDtUnitOptions& options)
    : options_(options), period_(std::llround(1e9 / options.rate_hz)),
      motion_(options.motion, options.side, options.seed), streaming_(options.wireless) {
  assert(options.rate_hz >= 1.0 &&
         options.rate_hz <= (options.wireless ? max_wireless_rate_hz : max_rate_hz));
}

void FiveDtUnit::receive(std::span<const std::byte> bytes, Time now) {
  advance(now);
  if (options_.wireless) return;
  for (const std::byte byte : bytes)
    handle(std::to_integer<Byte>(byte), now);
}

void FiveDtUnit::handle(Byte command, Time now) {
  const auto send_one = [&] {
    const auto bytes = sample(now);
    send_record(std::as_bytes(std::span(bytes)));
  };
  switch (command) {
  case 'A':
    streaming_ = false;
    send_bytes({acknowledge});
    return;
  case 'C':
    send_one();
    return;
  case 'D':
    streaming_ = true;
    next_sample_ = now + period_;
    return;
  case 'G':
    send_bytes(information());
    return;
  default:
    return;
  }
}

void FiveDtUnit::advance(Time now) {
  if (!motion_origin_) {
    motion_origin_ = now;
    next_sample_ = now + period_;
  }
  if (!streaming_) return;
  send_due(next_sample_, period_, now, [this](Time due) { return sample(due); });
}

std::optional<EmulatedUnit::Time> FiveDtUnit::next_due() const noexcept {
  if (!streaming_) return std::nullopt;
  return next_sample_;
}

std::vector<FiveDtUnit::Byte> FiveDtUnit::information() const {
  std::vector<Byte> bytes(32, 0);
  constexpr std::string_view name = "DataGlove 5";
  bytes[0] = 'B';
  bytes[1] = 'R';
  bytes[2] = 2;
  bytes[3] = 3;
  bytes[4] = options_.side == Side::right ? 1 : 0;
  bytes[5] = 16; // it measures pitch and roll
  std::copy(name.begin(), name.end(), bytes.begin() + 16);
  return bytes;
}

std::vector<FiveDtUnit::Byte> FiveDtUnit::sample(Time now) const {
  const auto angles = motion_.at(std::chrono::duration<double>(now - *motion_origin_).count());
  std::vector<Byte> bytes{0x80};
  for (const Sensor sensor : flexions)
    bytes.push_back(flexion_count(angles, sensor));
  if (options_.left_little_first && options_.side == Side::left)
    std::reverse(bytes.begin() + 1, bytes.end());
  bytes.insert(bytes.end(), {level, level});
  Byte sum = 0;
  for (std::size_t k = 1; k < bytes.size(); ++k)
    sum = static_cast<Byte>(sum ^ bytes[k]);
  bytes.push_back(sum);
  if (options_.wireless) {
    bytes.push_back(options_.side == Side::right ? 0x01 : 0x40); // as VRPN has it
  } else if (options_.ten_bytes) {
    bytes.push_back(acknowledge);
  }
  return bytes;
}

void FiveDtUnit::send_bytes(const std::vector<Byte>& bytes) {
  send(std::as_bytes(std::span(bytes)));
}

} // namespace nendo::emulator
