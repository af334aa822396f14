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
#include "stream/findings.hpp"
#include "stream/stream_counters.hpp"

namespace nendo::driver::forte {

struct Record {
  std::array<std::uint8_t, sensor_count> flexion{}; ///< in the order of `slots`, 0 to max_count
  std::uint8_t battery = 0;                         ///< in an unknown unit
  unsigned clamped = 0; ///< counts that were above max_count, and are set to it
};

/// Decodes a whole frame with its first and last byte. Returns nothing if it is no record: it has
/// another kind or length.
std::optional<Record> decode_record(std::span<const std::byte> frame) noexcept;

class Parser {
public:
  /// Takes the next bytes of the stream, cut anywhere, and hands each record to `sink(const
  /// Record&)`. Damaged frames count as bad, once each; frames of motion and what stands between
  /// frames are discarded.
  template <class Sink>
  void push(std::span<const std::byte> chunk, Sink&& sink) {
    for (const std::byte byte : chunk) {
      const auto record = push_byte(byte);
      for (; bad_ > 0; --bad_)
        report(sink, BadRecord{});
      if (record) sink(*record);
    }
  }

  /// Drops the unfinished frame. The next byte may come from anywhere in a frame.
  void reset() noexcept;
  /// See StreamCounters::count_discarded.
  void count_discarded(std::uint64_t bytes) noexcept { counters_.count_discarded(bytes); }

  const StreamCounters& counters() const noexcept { return counters_; }
  /// Returns the bytes of the unfinished frame, always less than record_bytes.
  std::size_t pending() const noexcept { return held_; }

private:
  enum class State : std::uint8_t {
    between,  ///< two frames
    in_frame, ///< that may be a record
    skipping, ///< the rest of a frame that is no record, or whose beginning was not seen
  };

  std::optional<Record> push_byte(std::byte byte) noexcept;
  std::optional<Record> end_frame() noexcept;
  void skip_byte(std::byte byte) noexcept;
  void discard_held() noexcept;
  void count_bad() noexcept { ++counters_.bad_records, ++bad_; }

  State state_ = State::skipping;
  std::array<std::byte, record_bytes> frame_{};
  std::size_t held_ = 0; ///< 0 outside in_frame
  unsigned bad_ = 0;     ///< found by the last byte, not yet told
  StreamCounters counters_;
};

} // namespace nendo::driver::forte
