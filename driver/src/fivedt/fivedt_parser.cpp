#include "fivedt/fivedt_parser.hpp"

#include <algorithm>

namespace nendo::driver::fivedt {
namespace {

constexpr std::byte mark(std::size_t k) noexcept {
  return static_cast<std::byte>(information_mark[k]);
}

std::string printable(std::span<const std::byte> text) {
  std::string line;
  for (const std::byte byte : text) {
    const char c = std::to_integer<char>(byte);
    if (c == '\0') break;
    if (c >= 0x20 && c < 0x7F && (c != ' ' || !line.empty())) line.push_back(c);
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

} // namespace

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
  frame_[held_++] = byte;
  while (held_ > 0 && frame_.front() != header)
    drop_first();
  if (held_ < frame_.size()) return std::nullopt;
  if (const auto record = decode_record(frame_)) {
    accept_held();
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
  discard_held();
  in_step_ = false;
}

std::optional<Information>
decode_information(std::span<const std::byte, information_bytes> answer) {
  if (answer[0] != mark(0) || answer[1] != mark(1)) return std::nullopt;
  const auto at = [&](std::size_t k) { return std::to_integer<std::uint8_t>(answer[k]); };
  Information information;
  information.version_major = at(version_at);
  information.version_minor = at(version_at + 1);
  information.side = (at(hand_at) & right_hand_bit) != 0 ? Side::right : Side::left;
  information.tilt_sensor = (at(abilities_at) & tilt_bit) != 0;
  information.name = printable(answer.subspan(name_at));
  return information;
}

bool InformationFinder::push(std::span<const std::byte> chunk) noexcept {
  for (const std::byte byte : chunk) {
    if (held_ == answer_.size()) break;
    if (held_ == 1 && byte != mark(1)) held_ = 0;
    if (held_ == 0 && byte != mark(0)) continue;
    answer_[held_++] = byte;
  }
  return held_ == answer_.size();
}

} // namespace nendo::driver::fivedt
