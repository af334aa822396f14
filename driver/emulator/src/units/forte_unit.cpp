#include "units/forte_unit.hpp"

#include <cassert>
#include <cmath>

namespace nendo::emulator {
namespace {

constexpr std::array joints{Sensor::thumb_mcp, Sensor::thumb_ip,   Sensor::index_mcp,
                            Sensor::index_pip, Sensor::middle_mcp, Sensor::middle_pip,
                            Sensor::ring_mcp,  Sensor::ring_pip,   Sensor::little_mcp,
                            Sensor::little_pip};
constexpr std::uint8_t battery = 100;
/// What a frame of motion holds is not known, but that it has twelve bytes.
constexpr std::array<std::uint8_t, 16> motion_frame{0xF0, 2, 12, 0, 0, 0, 0, 0,
                                                    0,    0, 0,  0, 0, 0, 0, 0xF7};

std::uint8_t flexion_byte(const driver::JointAngles& angles, Sensor sensor) {
  return static_cast<std::uint8_t>(std::lround(driver::part_of_range(angles, sensor) * 127.0));
}

} // namespace

ForteUnit::ForteUnit(const ForteUnitOptions& options)
    : options_(options), period_(std::llround(1e9 / options.rate_hz)),
      motion_(options.motion, options.side, options.seed) {
  assert(options.rate_hz >= 1.0 && options.rate_hz <= max_rate_hz);
}

void ForteUnit::receive(std::span<const std::byte> bytes, Time now) {
  advance(now);
  for (const std::byte byte : bytes) {
    last_ = {last_[1], last_[2], std::to_integer<Byte>(byte)};
    handle(now);
  }
}

void ForteUnit::handle(Time now) {
  const bool streamed = streams();
  if (last_ == std::array<Byte, 3>{176, 115, 1}) data_on_ = true;
  if (last_ == std::array<Byte, 3>{176, 118, 1}) linked_ = !options_.bluetooth;
  if (last_ == std::array<Byte, 3>{176, 118, 2}) linked_ = options_.bluetooth;
  if (streams() && !streamed) next_record_ = now + period_;
}

void ForteUnit::advance(Time now) {
  if (!motion_origin_) motion_origin_ = now;
  if (!streams()) return;
  for (; next_record_ <= now; next_record_ += period_) {
    const auto bytes = record(next_record_);
    const bool sent = send_record(std::as_bytes(std::span(bytes)));
    if (send(std::as_bytes(std::span(motion_frame))) && sent) continue;
    // The output is full: account for the others that are due without making them.
    const auto others = (now - next_record_) / period_;
    counters_.bytes_refused +=
        (bytes.size() + motion_frame.size()) * static_cast<std::uint64_t>(others);
    next_record_ += others * period_;
  }
}

std::optional<EmulatedUnit::Time> ForteUnit::next_due() const noexcept {
  if (!streams()) return std::nullopt;
  return next_record_;
}

std::vector<ForteUnit::Byte> ForteUnit::record(Time now) const {
  const auto angles = motion_.at(std::chrono::duration<double>(now - *motion_origin_).count());
  std::vector<Byte> bytes{240, 1, 11};
  for (const Sensor joint : joints)
    bytes.push_back(flexion_byte(angles, joint));
  bytes.insert(bytes.end(), {battery, 247});
  return bytes;
}

} // namespace nendo::emulator
