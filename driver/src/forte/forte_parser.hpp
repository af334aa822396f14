#pragma once
// Splits the byte stream of a Forte glove into records. It is pure (no I/O, clock, log or
// allocation), and bytes are not trusted. A frame's first byte occurs nowhere else, so the next
// frame is found after any damage.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "forte/forte_protocol.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::forte {

struct Record {
  std::array<std::uint8_t, sensor_count> flexion{}; ///< in the order of `slots`, 0 to max_count
  std::uint8_t battery = 0;                         ///< in an unknown unit
  unsigned clamped = 0;                             ///< counts above max_count, which are set to it
};

/// Decodes a whole frame with its first and last byte. Returns nothing if it is no record: it has
/// another kind or length.
std::optional<Record> decode_record(std::span<const std::byte> frame) noexcept;

/// Frames of motion, and bytes between frames, are discarded and are not bad.
class Parser : public StreamParser<Parser> {
public:
  /// Drops the unfinished frame. The next byte may come from anywhere in a frame.
  void reset() noexcept;

private:
  friend StreamParser;

  enum class State : std::uint8_t {
    between,  ///< between two frames
    in_frame, ///< in a frame that may be a record
    skipping, ///< in the rest of a frame that is no record, or whose beginning was not seen
  };

  std::optional<Record> push_byte(std::byte byte) noexcept;
  std::optional<Record> end_frame() noexcept;
  void skip_byte(std::byte byte) noexcept;

  State state_ = State::skipping;
  std::array<std::byte, record_bytes> frame_{};
};

} // namespace nendo::driver::forte
