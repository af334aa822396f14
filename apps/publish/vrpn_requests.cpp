#include "publish/vrpn_requests.hpp"

#include <algorithm>
#include <string_view>

#include <nendo/base/byte_reader.hpp>

#include "publish/vrpn_messages.hpp"

namespace nendo::publish::vrpn {
namespace {

namespace protocol = driver::vrpn;

using protocol::is_number;
using protocol::text_of;

} // namespace

bool Requests::push(std::span<const std::byte> bytes, std::vector<std::size_t>& pinged) {
  while (!bytes.empty() && !is_broken_) {
    const bool skips = to_skip_ > 0;
    const auto part =
        bytes.first(std::min(skips ? to_skip_ : expected_ - held_.size(), bytes.size()));
    bytes = bytes.subspan(part.size());
    if (skips) {
      to_skip_ -= part.size();
      continue;
    }
    held_.insert(held_.end(), part.begin(), part.end());
    if (held_.size() == expected_) take_held(pinged);
  }
  return !is_broken_;
}

/// Takes the cookie, a header or a whole message.
void Requests::take_held(std::vector<std::size_t>& pinged) {
  if (!has_greeted_) {
    has_greeted_ = text_of(held_).starts_with(protocol::cookie_agreed);
    is_broken_ = !has_greeted_;
  } else if (expected_ == protocol::header_bytes) {
    const std::size_t length = ByteReader(held_).u32_be();
    is_broken_ = length < protocol::header_bytes || length > protocol::max_message_bytes;
    const std::size_t rest = is_broken_ ? 0 : protocol::padded(length - protocol::header_bytes);
    if (rest > 0 && protocol::header_bytes + rest <= max_held_bytes) {
      expected_ += rest;
      return;
    }
    to_skip_ = rest;
    if (rest == 0 && !is_broken_) take_message(held_, pinged);
  } else {
    take_message(held_, pinged);
  }
  held_.clear();
  expected_ = protocol::header_bytes;
}

void Requests::take_message(std::span<const std::byte> message, std::vector<std::size_t>& pinged) {
  ByteReader reader(message);
  const std::size_t length = reader.u32_be();
  reader.take(8); // time
  const std::int32_t sender = reader.i32_be();
  const std::int32_t type = reader.i32_be();
  if (type == protocol::describes_sender || type == protocol::describes_type)
    return take_name(sender, type == protocol::describes_sender,
                     message.first(length).subspan(protocol::header_bytes));
  if (!is_number(sender) || !is_number(type) || !is_ping_[static_cast<std::size_t>(type)]) return;
  const std::uint8_t own = sender_of_[static_cast<std::size_t>(sender)];
  if (own != none) pinged.push_back(own);
}

void Requests::take_name(std::int32_t number, bool is_sender, std::span<const std::byte> payload) {
  if (!is_number(number)) return;
  const auto at = static_cast<std::size_t>(number);
  ByteReader reader(payload);
  const std::string_view name = text_of(reader.take(reader.u32_be()));
  if (!is_sender) {
    is_ping_.set(at, name == protocol::ping_name);
    return;
  }
  const auto* const own = std::find(sender_names.begin(), sender_names.end(), name);
  sender_of_[at] =
      own == sender_names.end() ? none : static_cast<std::uint8_t>(own - sender_names.begin());
}

} // namespace nendo::publish::vrpn
