#include "vrpn/vrpn_parser.hpp"

#include <algorithm>
#include <utility>

#include <nendo/base/byte_reader.hpp>

namespace nendo::driver::vrpn {

Parser::Parser(std::string tracker, std::vector<std::uint16_t> sensors)
    : tracker_(std::move(tracker)), sensors_(std::move(sensors)) {}

void Parser::reset() noexcept {
  discard_held();
  expect(State::in_cookie, cookie_bytes);
  is_tracker_.reset();
  type_kind_.fill(Kind::other);
}

void Parser::expect(State state, std::size_t bytes) noexcept {
  state_ = state;
  expected_ = bytes;
}

Parser::Finding Parser::push_byte(std::byte byte) noexcept {
  if (state_ == State::broken || state_ == State::skipping) {
    ++counters_.discarded_bytes;
    if (state_ == State::skipping && --to_skip_ == 0) expect(State::in_header, header_bytes);
    return {};
  }
  message_[held_++] = byte;
  if (held_ < expected_) return {};
  if (state_ == State::in_cookie) return end_cookie();
  if (state_ == State::in_header) return end_header();
  return end_message();
}

Parser::Finding Parser::end_cookie() noexcept {
  discard_held();
  const std::string_view text(reinterpret_cast<const char*>(message_.data()), cookie_version_bytes);
  const bool agrees = text.starts_with(cookie_agreed);
  if (agrees) {
    expect(State::in_header, header_bytes);
  } else {
    break_off();
  }
  return Greeting{text, agrees};
}

void Parser::break_off() noexcept {
  count_bad();
  state_ = State::broken;
}

/// For a whole message that says nothing usable.
Parser::Finding Parser::refuse() noexcept {
  count_bad();
  return {};
}

Parser::Kind Parser::kind_of(std::int32_t sender, std::int32_t type) const noexcept {
  if (type == describes_sender) return Kind::sender_name;
  if (type == describes_type) return Kind::type_name;
  if (!is_number(type) || !is_number(sender)) return Kind::other;
  const bool is_of_tracker = is_tracker_[static_cast<std::size_t>(sender)];
  return is_of_tracker ? type_kind_[static_cast<std::size_t>(type)] : Kind::other;
}

Parser::Finding Parser::end_header() noexcept {
  ByteReader reader{std::span(message_).first(header_bytes)};
  const std::size_t length = reader.u32_be();
  header_.seconds = reader.u32_be();
  header_.microseconds = reader.u32_be();
  header_.sender = reader.i32_be();
  header_.kind = kind_of(header_.sender, reader.i32_be());
  if (length < header_bytes || length > max_message_bytes) {
    discard_held();
    break_off();
    return {};
  }
  header_.payload_bytes = length - header_bytes;
  const std::size_t bytes = padded(header_.payload_bytes);
  const bool is_too_long = header_bytes + bytes > message_.size();
  if (header_.kind != Kind::other && is_too_long) count_bad();
  if (header_.kind == Kind::other || is_too_long) {
    discard_held();
    to_skip_ = bytes;
    if (bytes == 0) {
      expect(State::in_header, header_bytes);
    } else {
      state_ = State::skipping;
    }
    return {};
  }
  expect(State::in_payload, header_bytes + bytes);
  return bytes == 0 ? end_message() : Finding{};
}

Parser::Finding Parser::end_message() noexcept {
  expect(State::in_header, header_bytes);
  const auto payload =
      std::span<const std::byte>(message_).subspan(header_bytes, header_.payload_bytes);
  if (header_.kind == Kind::pose) return take_pose(payload);
  discard_held();
  if (header_.kind == Kind::pong) return Pong{};
  if (header_.kind == Kind::text) return take_text(payload);
  return take_name(payload);
}

/// The last description of a number is the valid one; several numbers may have one name.
Parser::Finding Parser::take_name(std::span<const std::byte> payload) noexcept {
  ByteReader reader(payload);
  const std::size_t length = reader.u32_be();
  const auto text = reader.take(length);
  if (reader.overrun() || length == 0 || length > max_name_bytes || !is_number(header_.sender))
    return refuse();
  const std::string_view name = text_of(text);
  const auto number = static_cast<std::size_t>(header_.sender);
  if (header_.kind == Kind::sender_name) {
    is_tracker_.set(number, name == tracker_);
    return SenderName{name};
  }
  type_kind_[number] = name == pose_name   ? Kind::pose
                       : name == text_name ? Kind::text
                       : name == pong_name ? Kind::pong
                                           : Kind::other;
  return {};
}

Parser::Finding Parser::take_pose(std::span<const std::byte> payload) noexcept {
  if (payload.size() != pose_payload_bytes) {
    discard_held();
    return refuse();
  }
  ByteReader reader(payload);
  const std::int32_t sensor = reader.i32_be();
  reader.take(4);
  const auto wanted = std::find(sensors_.begin(), sensors_.end(), sensor);
  if (!delivers_ || wanted == sensors_.end()) {
    discard_held();
    return OtherPose{sensor};
  }
  Pose pose;
  pose.sensor = *wanted;
  for (double& coordinate : pose.position_m)
    coordinate = reader.f64_be();
  for (double& component : pose.turn_xyzw)
    component = reader.f64_be();
  if (header_.seconds != 0 && header_.microseconds < 1'000'000)
    pose.stamp =
        std::chrono::seconds(header_.seconds) + std::chrono::microseconds(header_.microseconds);
  accept_held();
  return pose;
}

Parser::Finding Parser::take_text(std::span<const std::byte> payload) noexcept {
  ByteReader reader(payload);
  const std::uint32_t severity = reader.u32_be();
  reader.u32_be(); // the level, which only makes an order among messages of one severity
  if (reader.overrun()) return refuse();
  return Text{severity, text_of(reader.take(reader.remaining()))};
}

std::vector<std::byte> describe_ping(std::string_view tracker) {
  std::vector<std::byte> bytes;
  append_name(bytes, describes_sender, 0, tracker);
  append_name(bytes, describes_type, 0, ping_name);
  return bytes;
}

std::vector<std::byte> ping() {
  std::vector<std::byte> bytes;
  append_message(bytes, 0, 0, 0, {}); // servers do not use its time [C]
  return bytes;
}

} // namespace nendo::driver::vrpn
