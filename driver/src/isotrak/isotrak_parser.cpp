#include "isotrak/isotrak_parser.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <nendo/base/byte_reader.hpp>

namespace nendo::driver::isotrak {
namespace {

using Unpacked = std::array<std::byte, unpacked_bytes>;

/// Puts the bits 7 back, which the last byte of each group has.
Unpacked unpack(std::span<const std::byte, record_bytes> frame) noexcept {
  Unpacked bytes{};
  auto to = bytes.begin();
  for (std::size_t begin = 0; begin < frame.size(); begin += group_bytes + 1) {
    const std::size_t end = std::min(begin + group_bytes, frame.size() - 1);
    for (std::size_t at = begin; at < end; ++at) {
      const bool is_set = (frame[end] >> (at - begin) & std::byte{1}) != std::byte{0};
      *to++ = (frame[at] & std::byte{0x7F}) | (is_set ? std::byte{0x80} : std::byte{0});
    }
  }
  return bytes;
}

double next_word(ByteReader& reader) noexcept {
  return static_cast<std::int16_t>(reader.u16_le());
}

} // namespace

std::optional<Record> decode_record(std::span<const std::byte, record_bytes> frame) noexcept {
  const Unpacked bytes = unpack(frame);
  ByteReader reader(bytes);
  if (reader.u8() != '0') return std::nullopt;
  const std::uint8_t digit = reader.u8();
  if (digit < '1' || digit >= '1' + max_stations) return std::nullopt;
  const char letter = static_cast<char>(reader.u8());
  const bool is_button = letter == '*' || letter == '@';
  if (!is_button && !polhemus::is_error(letter)) return std::nullopt;

  Record record;
  record.station = static_cast<std::uint16_t>(digit - '0');
  if (!is_button) record.error = letter;
  for (double& coordinate_m : record.position_m)
    coordinate_m = next_word(reader) / full_scale * position_range_m;
  double squares = 0.0;
  for (const std::size_t k : {3U, 0U, 1U, 2U}) {
    record.turn_xyzw[k] = next_word(reader) / full_scale;
    squares += record.turn_xyzw[k] * record.turn_xyzw[k];
  }
  // The steps of the format change the norm by 0.0001 at most.
  const double norm = std::sqrt(squares);
  if (std::abs(norm - 1.0) > polhemus::max_norm_error) return std::nullopt;
  for (double& component : record.turn_xyzw)
    component /= norm;
  return record;
}

} // namespace nendo::driver::isotrak
