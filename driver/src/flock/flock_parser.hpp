#pragma once
// Splits the stream of a Flock of Birds into records. It is pure (no I/O, clock, log or
// allocation), and bytes are not trusted. A byte with bit 7 begins a record, and at any other place
// it is damage. Nothing else is checked on the line, so a quaternion must have the norm 1.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "flock/flock_protocol.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::flock {

struct Record {
  std::uint16_t station = 0;                ///< the bird's address
  std::array<std::int16_t, 3> position{};   ///< full_scale is the range, which units are set to
  std::array<std::int16_t, 4> quaternion{}; ///< w x y z; full_scale is 1
};

/// Decodes a record. Returns nothing if the bits 7, the address or the quaternion's norm are wrong.
std::optional<Record> decode_record(std::span<const std::byte, record_bytes> frame) noexcept;

/// Damage between two good records counts as bad once.
class Parser : public StreamParser<Parser> {
public:
  /// Drops the unfinished record. The next byte may come from anywhere in a record.
  void reset() noexcept;

private:
  friend StreamParser;

  std::optional<Record> push_byte(std::byte byte) noexcept;
  void drop_held() noexcept;

  std::array<std::byte, record_bytes> frame_{};
  bool in_step_ = false; ///< the last bytes were a good record
};

} // namespace nendo::driver::flock
