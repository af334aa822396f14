#pragma once
// Splits the byte stream of an ISOTRAK II into records. It is pure (no I/O, clock, log or
// allocation), and bytes are not trusted. Bit 7 frames a record. There is no checksum, so its first
// bytes and the norm of its quaternion are checked.

#include <cstddef>
#include <optional>
#include <span>

#include "isotrak/isotrak_protocol.hpp"
#include "polhemus/pose_record.hpp"
#include "stream/phase_bit_parser.hpp"

namespace nendo::driver::isotrak {

using Record = polhemus::PoseRecord;

/// Decodes a record, of which bit 7 is set in the first byte alone, and normalises its quaternion.
/// Returns nothing if the begin, the station or the button is none, or the quaternion's norm is not
/// 1.
std::optional<Record> decode_record(std::span<const std::byte, record_bytes> frame) noexcept;

using Parser = PhaseBitParser<Record, record_bytes, decode_record>;

} // namespace nendo::driver::isotrak
