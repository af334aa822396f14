#include "cyberglove/cyberglove_parser.hpp"

#include <algorithm>
#include <string_view>

#include <nendo/base/byte_reader.hpp>

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
/// gloves, so it is ignored.
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

// The layout of the high-resolution record (cyberglove_protocol.hpp).

constexpr std::string_view time_pattern = "00:00:00:00:0S"; ///< 0 stands for any digit
constexpr std::string_view tail{"\r\n\0", 3};
static_assert(time_pattern.size() == hi_res_time_bytes);

constexpr int frames_per_second = 30;

int number_at(std::span<const std::byte> bytes, std::size_t tens) noexcept {
  const auto digit = [&](std::size_t k) { return std::to_integer<int>(bytes[k]) - '0'; };
  return 10 * digit(tens) + digit(tens + 1);
}

/// `last` is the index of the last byte, a digit or a separator.
bool continues_time(std::span<const std::byte> bytes, std::size_t last) noexcept {
  const auto c = std::to_integer<char>(bytes[last]);
  if (time_pattern[last] != '0') return c == time_pattern[last];
  if (c < '0' || c > '9') return false;
  switch (last) {
  case 1:
    return number_at(bytes, 0) < 24;
  case 4:
    return number_at(bytes, 3) < 60;
  case 7:
    return number_at(bytes, 6) < 60;
  case 10:
    return number_at(bytes, 9) <= frames_per_second;
  default:
    return true;
  }
}

/// Returns whether the last of `bytes`, at most hi_res_bytes, fits the layout. The others must fit.
bool continues_hi_res(std::span<const std::byte> bytes) noexcept {
  constexpr std::size_t values_end = hi_res_bytes - tail.size();
  const std::size_t last = bytes.size() - 1;
  if (last < hi_res_time_bytes) return continues_time(bytes, last);
  if (last >= values_end) return std::to_integer<char>(bytes[last]) == tail[last - values_end];
  const bool high = (last - hi_res_time_bytes) % 2 == 0;
  return !high || std::to_integer<unsigned>(bytes[last]) <= hi_res_max >> 8U;
}

/// Returns whether `bytes`, fewer than hi_res_bytes, may begin a record.
bool begins_hi_res(std::span<const std::byte> bytes) noexcept {
  for (std::size_t count = 1; count <= bytes.size(); ++count) {
    if (!continues_hi_res(bytes.first(count))) return false;
  }
  return true;
}

/// Returns the content of a whole record, for which continues_hi_res() was true at every byte.
Record read_hi_res(std::span<const std::byte> frame) noexcept {
  Record record;
  const int minutes = 60 * number_at(frame, 0) + number_at(frame, 3);
  record.second = static_cast<std::uint32_t>(60 * minutes + number_at(frame, 6));
  record.frame = static_cast<std::uint8_t>(number_at(frame, 9));
  record.sub_frame = static_cast<std::uint8_t>(std::to_integer<int>(frame[12]) - '0');
  ByteReader reader(frame.subspan(hi_res_time_bytes));
  for (std::size_t k = 0; k < hi_res_values; ++k) {
    const unsigned high = reader.u8();
    const auto value = static_cast<std::uint16_t>(high << 8U | reader.u8());
    record.values[k] = std::max<std::uint16_t>(value, 1);
    record.clamped += value == 0 ? 1U : 0U;
  }
  record.no_glove = record.clamped == hi_res_values;
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
    drop_bad_frame(); // that NUL was a terminator; the next frame begins after it
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
      return end_plain(); // with fewer bytes
    }
    if (may_be_stamp()) {
      nul_in_stamp_ = true;
      return std::nullopt;
    }
  }
  drop_bad_frame();
  return std::nullopt;
}

/// The last byte, a NUL, is at the first byte of a time stamp. Sources disagree if it can be NUL.
bool Parser::may_be_stamp() const noexcept {
  return shape_.time_stamp && held_ == 1 + shape_.values + 1 && is_header(frame_[0]);
}

/// Drops a frame up to its NUL: the last byte, or the one that was taken for a time stamp's.
void Parser::drop_bad_frame() noexcept {
  count_bad();
  discard(nul_in_stamp_ ? 1 + shape_.values + 1 : held_);
  overlong_ = nul_in_stamp_ = false;
}

/// The held bytes always begin a record; a byte that does not fit moves the beginning.
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
  counters_.clamped += record.clamped;
  counters_.too_fast += record.sampled_too_fast ? 1U : 0U;
  accept_held();
  return true;
}

/// Discards the first `count` held bytes.
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
