#include "cyberglove/cyberglove_parser.hpp"

#include <algorithm>

#include <nendo/base/byte_reader.hpp>

#include "cyberglove/hi_res_record.hpp"

namespace nendo::driver::cyberglove {
namespace {

struct ErrorPairs {
  bool no_glove = false;
  bool sampled_too_fast = false;
};

/// None, one or both pairs in any order [V]; anything else is damage.
std::optional<ErrorPairs> decode_errors(std::span<const std::byte> tail) noexcept {
  ErrorPairs errors;
  ByteReader reader(tail);
  while (reader.remaining() > 0) {
    if (reader.u8() != error_mark) return std::nullopt;
    const std::uint8_t which = reader.u8();
    bool* const flag = which == error_no_glove        ? &errors.no_glove
                       : which == error_sampling_rate ? &errors.sampled_too_fast
                                                      : nullptr;
    if (flag == nullptr || *flag) return std::nullopt;
    *flag = true;
  }
  return errors;
}

/// Flag bit k says that tick byte k is 0 and was sent as 1, as NUL cannot be sent [V, p.28]; a
/// flagged byte that is not 1 is damage. Bit 7 is documented to be set but was not seen set on real
/// gloves, so it is not looked at.
std::optional<std::uint32_t> decode_ticks(ByteReader& reader) noexcept {
  const unsigned flags = reader.u8();
  std::uint32_t ticks = 0;
  for (unsigned k = 0; k < 4; ++k) {
    const std::uint32_t sent = reader.u8();
    const bool was_zero = (flags >> k & 1U) != 0;
    if (sent == 0 || (was_zero && sent != 1)) return std::nullopt;
    if (!was_zero) ticks |= sent << 8U * k;
  }
  return ticks;
}

bool is_header(std::byte byte) noexcept {
  const auto letter = std::to_integer<char>(byte);
  return letter == polled_header || letter == stream_header || letter == synced_header;
}

std::optional<Record> decode_plain(std::span<const std::byte> frame,
                                   const RecordShape& shape) noexcept {
  if (frame.size() < shape.bytes() || frame.size() > shape.bytes() + max_error_bytes ||
      !is_header(frame[0])) {
    return std::nullopt;
  }
  ByteReader reader(frame.subspan(1));
  Record record;
  for (std::size_t k = 0; k < shape.values; ++k) {
    record.values[k] = reader.u8();
    if (record.values[k] == 0) return std::nullopt;
  }
  if (shape.time_stamp) {
    const auto ticks = decode_ticks(reader);
    if (!ticks) return std::nullopt;
    record.ticks = *ticks;
    record.stamp = Stamp::continues;
  }
  if (shape.status) {
    record.status = reader.u8();
    if ((record.status & status_always) == 0) return std::nullopt;
  }
  const auto errors = decode_errors(reader.take(reader.remaining() - 1));
  if (!errors || reader.u8() != 0) return std::nullopt;
  record.sampled_too_fast = errors->sampled_too_fast;
  record.no_glove = errors->no_glove;
  return record;
}

} // namespace

std::optional<Record> decode_record(std::span<const std::byte> frame,
                                    const RecordShape& shape) noexcept {
  if (shape.form == RecordForm::plain) return decode_plain(frame, shape);
  if (frame.size() != hi_res_bytes || !begins_hi_res(frame)) return std::nullopt;
  return read_hi_res(frame);
}

std::optional<Record> Parser::push_byte(std::byte byte) noexcept {
  ++counters_.bytes;
  frame_[held_++] = byte;
  return shape_.form == RecordForm::hi_res ? extend_hi_res() : extend_plain();
}

/// The record's bytes are still held.
void Parser::count_unplugged() noexcept {
  ++counters_.unplugged;
  discard(held_);
}

std::optional<Record> Parser::extend_plain() noexcept {
  if (frame_[held_ - 1] == terminator) return end_plain();
  if (held_ < shape_.bytes() + max_error_bytes) return std::nullopt;
  if (nul_in_stamp_) {
    drop_bad_frame(); // that NUL was a terminator; what followed it begins the next frame
  } else {
    overlong_ = true;
    discard(held_);
  }
  return std::nullopt;
}

std::optional<Record> Parser::end_plain() noexcept {
  if (!overlong_) {
    if (auto record = decode_plain(std::span(frame_).first(held_), shape_)) {
      nul_in_stamp_ = false;
      return record;
    }
    if (nul_in_stamp_) {
      drop_bad_frame();
      return end_plain(); // of what is left, which is shorter
    }
    if (may_be_stamp()) {
      nul_in_stamp_ = true;
      return std::nullopt;
    }
  }
  drop_bad_frame();
  return std::nullopt;
}

/// The last byte, a NUL, stands where a time stamp begins. Sources disagree if one can begin so.
bool Parser::may_be_stamp() const noexcept {
  return shape_.time_stamp && held_ == 1 + shape_.values + 1 && is_header(frame_[0]);
}

/// Up to its NUL: the last byte, or the one that was taken for a time stamp's.
void Parser::drop_bad_frame() noexcept {
  count_bad();
  discard(nul_in_stamp_ ? 1 + shape_.values + 1 : held_);
  overlong_ = nul_in_stamp_ = false;
}

/// What is held always begins a record; a byte that does not fit moves the beginning on.
std::optional<Record> Parser::extend_hi_res() noexcept {
  const auto held = std::span(frame_).first(held_);
  const std::byte byte = held.back();
  if (continues_hi_res(held)) {
    if (held_ == hi_res_bytes) {
      tail_ = 0;
      damage_counted_ = false;
      return read_hi_res(held);
    }
  } else {
    if (held_ > hi_res_time_bytes) {
      count_bad();
      damage_counted_ = true;
    }
    std::size_t skipped = 1;
    while (!begins_hi_res(held.subspan(skipped)))
      ++skipped;
    discard(skipped);
  }
  look_for_tail(byte);
  return std::nullopt;
}

/// A tail that ends no record ends a damaged one, whose beginning may have been damaged too.
void Parser::look_for_tail(std::byte byte) noexcept {
  switch (std::to_integer<char>(byte)) {
  case '\r':
    tail_ = 1;
    return;
  case '\n':
    tail_ = tail_ == 1 ? 2 : 0;
    return;
  case '\0':
    if (tail_ == 2 && held_ <= hi_res_time_bytes) {
      if (!damage_counted_) count_bad();
      damage_counted_ = false;
    }
    break;
  default:
    break;
  }
  tail_ = 0;
}

/// The record's bytes are still held.
bool Parser::settle(const Record& record, const Verdict& verdict) noexcept {
  counters_.missed += verdict.missed;
  if (!verdict.plausible) {
    ++counters_.bad_records;
    ++counters_.implausible;
    discard(held_);
    return false;
  }
  ++counters_.records;
  counters_.clamped += record.clamped;
  counters_.too_fast += record.sampled_too_fast ? 1U : 0U;
  counters_.record_bytes += held_;
  held_ = 0;
  return true;
}

/// The first `count` of the bytes held.
void Parser::discard(std::size_t count) noexcept {
  counters_.discarded_bytes += count;
  std::copy(frame_.begin() + static_cast<std::ptrdiff_t>(count),
            frame_.begin() + static_cast<std::ptrdiff_t>(held_), frame_.begin());
  held_ -= count;
}

void Parser::reset(const RecordShape& shape) noexcept {
  discard(held_);
  overlong_ = nul_in_stamp_ = damage_counted_ = false;
  tail_ = 0;
  shape_ = shape;
}

} // namespace nendo::driver::cyberglove
