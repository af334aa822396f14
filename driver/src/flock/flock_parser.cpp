#include "flock/flock_parser.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nendo::driver::flock {
namespace {

constexpr std::byte phase_bit{0x80};
/// Of the norm. The steps of the format change it by 0.0003 at most.
constexpr double norm_tolerance = 0.002;

bool has_phase_bit(std::byte byte) noexcept {
  return (byte & phase_bit) != std::byte{0};
}

/// The bits 2 to 8 of a value, and its bits 9 to 15.
std::int16_t value_of(std::byte low, std::byte high) noexcept {
  const unsigned bits =
      (std::to_integer<unsigned>(high) << 7U) | (std::to_integer<unsigned>(low) & 0x7FU);
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(bits << 2U));
}

bool is_unit(const std::array<std::int16_t, 4>& quaternion) noexcept {
  double square = 0.0;
  for (const std::int16_t part : quaternion)
    square += part / full_scale * (part / full_scale);
  return std::abs(std::sqrt(square) - 1.0) <= norm_tolerance;
}

} // namespace

std::optional<Record> decode_record(std::span<const std::byte, record_bytes> frame) noexcept {
  if (!has_phase_bit(frame.front())) return std::nullopt;
  if (std::any_of(frame.begin() + 1, frame.end(), has_phase_bit)) return std::nullopt;
  Record record;
  record.station = std::to_integer<std::uint16_t>(frame.back());
  if (record.station < 1 || record.station > max_address) return std::nullopt;
  for (std::size_t k = 0; k < record_values; ++k) {
    const std::int16_t value = value_of(frame[2 * k], frame[2 * k + 1]);
    (k < 3 ? record.position[k] : record.quaternion[k - 3]) = value;
  }
  if (!is_unit(record.quaternion)) return std::nullopt;
  return record;
}

std::optional<Record> Parser::push_byte(std::byte byte) noexcept {
  if (has_phase_bit(byte) && held_ > 0) drop_held();
  frame_[held_++] = byte;
  if (!has_phase_bit(frame_.front())) {
    drop_held();
    return std::nullopt;
  }
  if (held_ < record_bytes) return std::nullopt;
  const auto record = decode_record(frame_);
  if (!record) {
    drop_held();
    return std::nullopt;
  }
  accept_held();
  in_step_ = true;
  return record;
}

void Parser::drop_held() noexcept {
  discard_held();
  if (std::exchange(in_step_, false)) count_bad();
}

void Parser::reset() noexcept {
  discard_held();
  in_step_ = false;
}

} // namespace nendo::driver::flock
