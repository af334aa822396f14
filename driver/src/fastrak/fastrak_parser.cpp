#include "fastrak/fastrak_parser.hpp"

#include <algorithm>

#include <nendo/base/byte_reader.hpp>

#include "polhemus/pose_floats.hpp"

namespace nendo::driver::fastrak {
namespace {

constexpr std::byte carriage_return{'\r'};
constexpr std::byte line_feed{'\n'};

/// Returns 0 if the byte is no station's digit.
std::uint16_t station_of(std::byte byte) noexcept {
  const auto digit = std::to_integer<std::uint16_t>(byte);
  if (digit >= '1' && digit <= '9') return static_cast<std::uint16_t>(digit - '0');
  if (digit >= 'A' && digit <= 'C') return static_cast<std::uint16_t>(digit - 'A' + 10);
  return 0;
}

} // namespace

std::optional<Record> decode_record(std::span<const std::byte, record_bytes> frame) noexcept {
  ByteReader reader(frame);
  Record record;
  if (reader.u8() != static_cast<std::uint8_t>(record_begin)) return std::nullopt;
  record.station = station_of(static_cast<std::byte>(reader.u8()));
  record.error = static_cast<char>(reader.u8());
  if (record.station == 0 || !polhemus::is_error(record.error)) return std::nullopt;
  bool good = polhemus::read_pose(reader, record.position_m, record.turn_xyzw);
  good = good && reader.u8() == '\r' && reader.u8() == '\n';
  return good ? std::optional(record) : std::nullopt;
}

void Parser::expect(std::span<const std::uint16_t> stations) noexcept {
  stations_ = stations.empty() ? ~0U : 0U;
  for (const std::uint16_t station : stations)
    stations_ |= 1U << station;
}

void Parser::reset() noexcept {
  discard_held();
  is_aligned_ = true;
  is_in_step_ = false;
}

std::optional<Record> Parser::push_byte(std::byte byte) noexcept {
  frame_[held_++] = byte;
  if (!is_aligned_ || !fits(held_ - 1)) {
    lose_step();
    return std::nullopt;
  }
  if (held_ < record_bytes) return std::nullopt;
  is_in_step_ = true; // its frame is whole, whatever it contains
  const auto record = decode_record(frame_);
  if (record) {
    accept_held();
  } else {
    count_bad();
    discard_held();
  }
  return record;
}

/// Returns whether the held byte can be there in the frame of a record. Numbers may be anything.
bool Parser::fits(std::size_t at) const noexcept {
  switch (at) {
  case 0:
    return frame_[at] == std::byte{record_begin};
  case 1:
    return (stations_ & ~1U & (1U << station_of(frame_[at]))) != 0;
  case 2:
    return polhemus::is_error(std::to_integer<char>(frame_[at]));
  case record_bytes - 2:
    return frame_[at] == carriage_return;
  case record_bytes - 1:
    return frame_[at] == line_feed;
  default:
    return true;
  }
}

bool Parser::all_fit() const noexcept {
  for (std::size_t at = 0; at < held_; ++at)
    if (!fits(at)) return false;
  return true;
}

/// Drops the held bytes up to the next CR LF after which a record may begin. Damage counts once,
/// until records come again.
void Parser::lose_step() noexcept {
  if (is_in_step_) count_bad();
  is_in_step_ = false;
  is_aligned_ = false;
  for (std::size_t at = 1; at < held_ && !is_aligned_; ++at) {
    if (frame_[at - 1] != carriage_return || frame_[at] != line_feed) continue;
    drop(at + 1);
    at = 0;
    is_aligned_ = all_fit();
  }
  if (is_aligned_) return;
  const bool may_end = held_ > 0 && frame_[held_ - 1] == carriage_return;
  drop(may_end ? held_ - 1 : held_);
}

void Parser::drop(std::size_t bytes) noexcept {
  std::copy(frame_.begin() + static_cast<std::ptrdiff_t>(bytes),
            frame_.begin() + static_cast<std::ptrdiff_t>(held_), frame_.begin());
  held_ -= bytes;
  counters_.discarded_bytes += bytes;
}

} // namespace nendo::driver::fastrak
