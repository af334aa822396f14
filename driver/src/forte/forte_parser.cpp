#include "forte/forte_parser.hpp"

#include <algorithm>
#include <utility>

#include <nendo/base/byte_reader.hpp>

namespace nendo::driver::forte {

std::optional<Record> decode_record(std::span<const std::byte> frame) noexcept {
  ByteReader reader(frame);
  bool good = reader.u8() == std::to_integer<std::uint8_t>(frame_begin);
  good = reader.u8() == record_id && good;
  good = reader.u8() == record_length && good;
  Record record;
  for (std::uint8_t& count : record.flexion) {
    const std::uint8_t sent = reader.u8();
    count = std::min(sent, max_count);
    record.clamped += sent > max_count ? 1U : 0U;
  }
  record.battery = reader.u8();
  good = reader.u8() == std::to_integer<std::uint8_t>(frame_end) && good;
  if (!good || reader.overrun() || reader.remaining() != 0) return std::nullopt;
  return record;
}

std::optional<Record> Parser::push_byte(std::byte byte) noexcept {
  if (byte == frame_begin) {
    if (state_ == State::in_frame) {
      count_bad();
      discard_held();
    }
    state_ = State::in_frame;
  }
  if (state_ != State::in_frame) {
    skip_byte(byte);
    return std::nullopt;
  }
  frame_[held_++] = byte;
  if (byte == frame_end) return end_frame();
  const bool motion = held_ == 2 && byte == motion_id;
  const bool overlong = held_ == record_bytes;
  if (motion || overlong) {
    if (overlong) count_bad();
    discard_held();
    state_ = State::skipping;
  }
  return std::nullopt;
}

std::optional<Record> Parser::end_frame() noexcept {
  state_ = State::between;
  const auto record = decode_record(std::span(frame_).first(held_));
  if (!record) {
    count_bad();
    discard_held();
    return std::nullopt;
  }
  counters_.clamped += record->clamped;
  accept_held();
  return record;
}

/// An end without a beginning is a frame that lost it.
void Parser::skip_byte(std::byte byte) noexcept {
  ++counters_.discarded_bytes;
  if (byte != frame_end) return;
  if (std::exchange(state_, State::between) == State::between) count_bad();
}

void Parser::reset() noexcept {
  discard_held();
  state_ = State::skipping;
}

} // namespace nendo::driver::forte
