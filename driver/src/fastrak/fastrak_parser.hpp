#pragma once
// Splits the byte stream of a FASTRAK into records. It is pure (no I/O, clock, log or allocation),
// and bytes are not trusted.
//
// Floats contain each byte that begins or ends a record, and there is no checksum. So a record must
// follow the end of another one, have its begin, a wanted station, an error letter and its end, and
// be a pose. What follows it is not awaited, which would delay each pose by a cycle of 8 ms. If no
// record follows, the next one is again searched for after a CR LF.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "fastrak/fastrak_protocol.hpp"
#include "polhemus/pose_record.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::fastrak {

using Record = polhemus::PoseRecord;

/// Decodes a whole record. Returns nothing if the begin, the station, the error letter or the end
/// is none, or the numbers are no pose in reach.
std::optional<Record> decode_record(std::span<const std::byte, record_bytes> frame) noexcept;

class Parser : public StreamParser<Parser> {
public:
  /// Takes records of these stations only, of all if there are none.
  void expect(std::span<const std::uint16_t> stations) noexcept;
  /// Drops the unfinished record. The next byte begins one, or comes from anywhere in one.
  void reset() noexcept;

private:
  friend StreamParser;

  std::optional<Record> push_byte(std::byte byte) noexcept;
  bool fits(std::size_t at) const noexcept;
  bool all_fit() const noexcept;
  void lose_step() noexcept;
  void drop(std::size_t bytes) noexcept;

  std::array<std::byte, record_bytes> frame_{};
  std::uint32_t stations_ = ~0U; ///< bit k: station k is taken
  bool is_aligned_ = true;       ///< a record may begin with frame_[0]
  bool is_in_step_ = false;      ///< a record ended just before frame_[0]
};

} // namespace nendo::driver::fastrak
