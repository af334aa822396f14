#pragma once
// The CyberGlove's byte stream, taken apart into records. Pure: no I/O, clock, log or allocation;
// bytes are hostile. Framing finds the NULs, which occur nowhere else; decoding judges what stands
// between two of them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "cyberglove/cyberglove_protocol.hpp"
#include "stream/stream_counters.hpp"

namespace nendo::driver::cyberglove {

/// What a record is expected to hold; `values` is 1 to most_values.
struct RecordShape {
  std::size_t values = 22;
  bool time_stamp = false;
  bool status = false;

  /// Without error pairs, with header and NUL.
  constexpr std::size_t bytes() const noexcept {
    return 1 + values + (time_stamp ? time_stamp_bytes : 0U) + (status ? 1U : 0U) + 1;
  }
};

struct Record {
  std::array<std::uint8_t, most_values>
      values{};                  ///< the first RecordShape::values are set, none of them 0
  std::uint32_t ticks = 0;       ///< 1/115200 s, if the shape has a time stamp
  bool sampled_too_fast = false; ///< the glove could not keep its period; the values are good
};

/// Judges one frame, its NUL included. Nothing if length, header or content are wrong or the glove
/// is unplugged.
std::optional<Record> decode_record(std::span<const std::byte> frame,
                                    const RecordShape& shape) noexcept;

class Parser {
public:
  explicit Parser(const RecordShape& shape) noexcept : shape_(shape) {}

  /// Takes the next bytes of the stream, cut anywhere, and hands each whole record to `sink(const
  /// Record&)`.
  template <class Sink>
  void push(std::span<const std::byte> chunk, Sink&& sink) {
    for (const std::byte byte : chunk) {
      if (const auto record = push_byte(byte)) sink(*record);
    }
  }

  /// Gives up the unfinished record and goes on with records of another shape.
  void reset(const RecordShape& shape) noexcept;
  /// Counts bytes that somebody else read from the same stream and that were no records.
  void count_discarded(std::uint64_t bytes) noexcept;

  const StreamCounters& counters() const noexcept { return counters_; }
  /// Bytes of the unfinished record; always less than most_record_bytes.
  std::size_t pending() const noexcept { return held_; }

private:
  std::optional<Record> push_byte(std::byte byte) noexcept;
  void discard_held() noexcept;

  RecordShape shape_;
  std::array<std::byte, most_record_bytes> frame_{};
  std::size_t held_ = 0;
  bool overlong_ = false; ///< the frame outgrew every record; skip to its NUL
  StreamCounters counters_;
};

} // namespace nendo::driver::cyberglove
