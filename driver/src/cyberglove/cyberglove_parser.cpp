#include "cyberglove/cyberglove_parser.hpp"

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

/// Flag bit k says that tick byte k is 0 and was sent as 1, as NUL cannot be sent [V, p.28]. Bit 7
/// is documented to be set but was not seen set on real gloves, so it is not looked at.
std::uint32_t decode_ticks(ByteReader& reader) noexcept {
  const std::uint32_t flags = reader.u8();
  std::uint32_t ticks = reader.u32_le();
  for (unsigned k = 0; k < 4; ++k) {
    if ((flags >> k & 1U) != 0) ticks &= ~(0xFFU << 8U * k);
  }
  return ticks;
}

} // namespace

std::optional<Record> decode_record(std::span<const std::byte> frame,
                                    const RecordShape& shape) noexcept {
  if (frame.size() < shape.bytes() || frame.size() > shape.bytes() + most_error_bytes) {
    return std::nullopt;
  }
  ByteReader reader(frame);
  const std::uint8_t header = reader.u8();
  if (header != 'S' && header != 'G') return std::nullopt;
  Record record;
  for (std::size_t k = 0; k < shape.values; ++k) {
    record.values[k] = reader.u8();
    if (record.values[k] == 0) return std::nullopt;
  }
  if (shape.time_stamp) record.ticks = decode_ticks(reader);
  if (shape.status && (reader.u8() & status_always) == 0) return std::nullopt;
  const auto errors = decode_errors(reader.take(reader.remaining() - 1));
  if (!errors || errors->no_glove || reader.u8() != 0) return std::nullopt;
  record.sampled_too_fast = errors->sampled_too_fast;
  return record;
}

std::optional<Record> Parser::push_byte(std::byte byte) noexcept {
  ++counters_.bytes;
  frame_[held_++] = byte;
  if (byte != terminator) {
    if (held_ == frame_.size()) { // no record is as long and still unfinished
      overlong_ = true;
      discard_held();
    }
    return std::nullopt;
  }
  const auto record =
      overlong_ ? std::nullopt : decode_record(std::span(frame_).first(held_), shape_);
  overlong_ = false;
  if (!record) {
    ++counters_.bad_records;
    discard_held();
    return std::nullopt;
  }
  ++counters_.records;
  counters_.record_bytes += held_;
  held_ = 0;
  return record;
}

void Parser::discard_held() noexcept {
  counters_.discarded_bytes += held_;
  held_ = 0;
}

void Parser::reset(const RecordShape& shape) noexcept {
  discard_held();
  overlong_ = false;
  shape_ = shape;
}

void Parser::count_discarded(std::uint64_t bytes) noexcept {
  counters_.bytes += bytes;
  counters_.discarded_bytes += bytes;
}

} // namespace nendo::driver::cyberglove
