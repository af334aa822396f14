#pragma once
// Splits the byte stream of a LIBERTY, PATRIOT or Latus into records. It is pure (no I/O, clock,
// log or allocation), and bytes are not trusted. The header, the length and the end frame a record,
// so the next one is found after any damage.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "liberty/liberty_protocol.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::liberty {

struct Record {
  std::size_t model = 0; ///< index in `models`
  std::uint16_t station = 0;
  char error = ' ';
  std::uint32_t time_ms = 0;
  std::uint32_t frame = 0;
  std::int32_t distortion = 0;
  std::array<double, 3> position_m{};
  std::array<double, 4> turn_xyzw{};
};

/// Decodes a whole record, which may be a short one. Returns nothing if header or end are those of
/// no record, or the numbers are no pose in reach.
std::optional<Record> decode_record(std::span<const std::byte> frame) noexcept;

class Parser : public StreamParser<Parser> {
public:
  /// Drops the unfinished record. The next byte may come from anywhere in a record, and records
  /// have full_bytes or short_bytes.
  void reset(std::size_t record_bytes = full_bytes) noexcept;
  /// Counts records that were sent and not delivered, by the numbers of their frames.
  void count_missed(std::uint64_t records) noexcept { counters_.missed += records; }

private:
  friend StreamParser;

  std::optional<Record> push_byte(std::byte byte) noexcept;
  bool may_be_record() const noexcept;
  void drop(std::size_t bytes) noexcept;

  std::array<std::byte, full_bytes> frame_{};
  std::size_t record_bytes_ = full_bytes;
  bool is_in_step_ = false; ///< a record ended just before frame_[0]
};

} // namespace nendo::driver::liberty
