#include "liberty/liberty_parser.hpp"

#include <algorithm>

#include <nendo/base/byte_reader.hpp>

#include "polhemus/pose_floats.hpp"

namespace nendo::driver::liberty {
namespace {

std::optional<std::size_t> model_of(char first, char second) noexcept {
  for (std::size_t at = 0; at < models.size(); ++at)
    if (models[at].letters == std::array{first, second}) return at;
  return std::nullopt;
}

/// Returns whether a header's length is that of a record of so many bytes. No source says whether
/// the length counts the header.
bool is_length_of(std::size_t size, std::size_t record_bytes) noexcept {
  return size == record_bytes || size + header_bytes == record_bytes;
}

} // namespace

std::optional<Record> decode_record(std::span<const std::byte> frame) noexcept {
  ByteReader reader(frame);
  Record record;
  const char first = static_cast<char>(reader.u8());
  const auto model = model_of(first, static_cast<char>(reader.u8()));
  record.station = reader.u8();
  reader.u8(); // the command, `C` or `P`
  record.error = static_cast<char>(reader.u8());
  reader.u8();
  if (!model || !is_length_of(reader.u16_le(), frame.size())) return std::nullopt;
  record.model = *model;
  record.time_ms = reader.u32_le();
  record.frame = reader.u32_le();
  if (frame.size() == full_bytes) record.distortion = static_cast<std::int32_t>(reader.u32_le());
  bool good = record.station >= 1 && record.station <= max_stations;
  good = polhemus::read_pose(reader, record.position_m, record.turn_xyzw) && good;
  good = good && reader.u8() == '\r' && reader.u8() == '\n' && !reader.overrun();
  return good ? std::optional(record) : std::nullopt;
}

void Parser::reset(std::size_t record_bytes) noexcept {
  discard_held();
  record_bytes_ = record_bytes;
  is_in_step_ = false;
}

std::optional<Record> Parser::push_byte(std::byte byte) noexcept {
  frame_[held_++] = byte;
  while (held_ > 0) {
    const bool is_possible = may_be_record();
    if (is_possible && held_ < record_bytes_) return std::nullopt;
    const auto record = is_possible ? decode_record(std::span(frame_).first(held_)) : std::nullopt;
    if (record) {
      is_in_step_ = true;
      accept_held();
      return record;
    }
    // Damage counts once, until records come again.
    if (is_in_step_) count_bad();
    is_in_step_ = false;
    drop(1);
  }
  return std::nullopt;
}

/// Checks as much of the header as is held.
bool Parser::may_be_record() const noexcept {
  const auto at = [this](std::size_t k) { return std::to_integer<std::uint8_t>(frame_[k]); };
  const bool begins = std::any_of(models.begin(), models.end(), [&](const Model& model) {
    return static_cast<char>(at(0)) == model.letters[0] &&
           (held_ < 2 || static_cast<char>(at(1)) == model.letters[1]);
  });
  if (!begins || (held_ > 2 && (at(2) < 1 || at(2) > max_stations))) return false;
  if (held_ > 3 && at(3) != 'C' && at(3) != 'P') return false;
  if (held_ < header_bytes) return true;
  return is_length_of(at(6) | (static_cast<std::size_t>(at(7)) << 8U), record_bytes_);
}

void Parser::drop(std::size_t bytes) noexcept {
  std::copy(frame_.begin() + static_cast<std::ptrdiff_t>(bytes),
            frame_.begin() + static_cast<std::ptrdiff_t>(held_), frame_.begin());
  held_ -= bytes;
  counters_.discarded_bytes += bytes;
}

} // namespace nendo::driver::liberty
