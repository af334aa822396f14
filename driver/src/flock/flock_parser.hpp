#pragma once
// Splits the stream of a Flock of Birds into records. It is pure (no I/O, clock, log or
// allocation), and bytes are not trusted. Nothing but bit 7 is checked on the line, so a quaternion
// must have the norm 1.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "flock/flock_protocol.hpp"
#include "stream/phase_bit_parser.hpp"

namespace nendo::driver::flock {

struct Record {
  std::uint16_t station = 0;                ///< the bird's address
  std::array<std::int16_t, 3> position{};   ///< full_scale is the range, which units are set to
  std::array<std::int16_t, 4> quaternion{}; ///< w x y z; full_scale is 1
};

/// Decodes a record, of which bit 7 is set in the first byte alone. Returns nothing if the address
/// or the quaternion's norm is wrong.
std::optional<Record> decode_record(std::span<const std::byte, record_bytes> frame) noexcept;

using Parser = PhaseBitParser<Record, record_bytes, decode_record>;

} // namespace nendo::driver::flock
