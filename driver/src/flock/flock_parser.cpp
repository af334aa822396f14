#include "flock/flock_parser.hpp"

#include <cmath>

namespace nendo::driver::flock {
namespace {

/// Of the norm. The steps of the format change it by 0.0003 at most.
constexpr double norm_tolerance = 0.002;

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

} // namespace nendo::driver::flock
