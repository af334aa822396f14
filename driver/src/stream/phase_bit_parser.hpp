#pragma once
// The parser for devices whose records have one length, and of which bit 7 is set in the first byte
// alone. A byte with bit 7 begins a record, and at any other place it is damage.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include "stream/stream_parser.hpp"

namespace nendo::driver {

constexpr bool has_phase_bit(std::byte byte) noexcept {
  return (byte & std::byte{0x80}) != std::byte{0};
}

/// `decode` is pure, takes the bytes of a record, and returns nothing if what they say is no
/// record. Damage between two good records counts as bad once.
template <class Record, std::size_t record_bytes,
          std::optional<Record> (*decode)(std::span<const std::byte, record_bytes>) noexcept>
class PhaseBitParser : public StreamParser<PhaseBitParser<Record, record_bytes, decode>> {
  using Base = StreamParser<PhaseBitParser>;

public:
  /// Drops the unfinished record. The next byte may come from anywhere in a record.
  void reset() noexcept {
    this->discard_held();
    in_step_ = false;
  }

private:
  friend Base;
  using Base::held_;

  std::optional<Record> push_byte(std::byte byte) noexcept {
    if (has_phase_bit(byte) && held_ > 0) drop_held();
    frame_[held_++] = byte;
    if (!has_phase_bit(frame_.front())) drop_held();
    if (held_ < record_bytes) return std::nullopt;
    const auto record = decode(frame_);
    if (record) {
      this->accept_held();
      in_step_ = true;
    } else {
      drop_held();
    }
    return record;
  }
  void drop_held() noexcept {
    this->discard_held();
    if (std::exchange(in_step_, false)) this->count_bad();
  }

  std::array<std::byte, record_bytes> frame_{};
  bool in_step_ = false; ///< the last bytes were a good record
};

} // namespace nendo::driver
