#include "fivedt/fivedt_parser.hpp"

#include <algorithm>
#include <utility>

namespace nendo::driver::fivedt {

std::optional<Record> decode_record(std::span<const std::byte, sample_bytes> frame) noexcept {
  if (frame.front() != header) return std::nullopt;
  std::byte sum{0};
  for (const std::byte byte : frame.subspan<1, data_bytes>())
    sum ^= byte;
  if (sum != frame.back()) return std::nullopt;
  Record record;
  for (std::size_t k = 0; k < fingers; ++k)
    record.flexion[k] = std::to_integer<std::uint8_t>(frame[1 + k]);
  return record;
}

std::optional<Record> Parser::push_byte(std::byte byte) noexcept {
  ++counters_.bytes;
  frame_[held_++] = byte;
  while (held_ > 0 && frame_.front() != header)
    drop_first();
  if (held_ < frame_.size()) return std::nullopt;
  if (const auto record = decode_record(frame_)) {
    ++counters_.records;
    counters_.record_bytes += held_;
    held_ = 0;
    extra_ = 0;
    in_step_ = true;
    return record;
  }
  do
    drop_first();
  while (held_ > 0 && frame_.front() != header);
  return std::nullopt;
}

void Parser::drop_first() noexcept {
  std::copy(frame_.begin() + 1, frame_.begin() + static_cast<std::ptrdiff_t>(held_),
            frame_.begin());
  --held_;
  ++counters_.discarded_bytes;
  if (in_step_ && ++extra_ > max_extra_bytes) {
    in_step_ = false;
    count_bad();
  }
}

void Parser::reset() noexcept {
  counters_.discarded_bytes += std::exchange(held_, 0);
  in_step_ = false;
}

} // namespace nendo::driver::fivedt
