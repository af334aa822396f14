#pragma once
// A receiver of OSC, written from the specification of OSC 1.0 alone.

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "publish/target.hpp"
#include <nendo/base/unique_fd.hpp>

namespace nendo::test {

/// A socket of this machine, bound to a port that was free.
class OscReceiver {
public:
  explicit OscReceiver(int family = AF_INET)
      : socket_(::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    SocketAddress address = Endpoint{family == AF_INET ? "127.0.0.1" : "::1"}.socket_address();
    is_bound_ = ::bind(socket_.get(), &address.address.any, address.length) == 0;
    ::getsockname(socket_.get(), &address.address.any, &address.length);
    target_.endpoint = endpoint_of(address);
    const int bytes = 4 << 20;
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
  }
  bool is_bound() const { return is_bound_; }
  const publish::OscTarget& target() const { return target_; }
  /// What has come, without waiting for more.
  std::optional<std::string> take() {
    std::string bytes(65536, '\0');
    const ssize_t got = ::recv(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (got < 0) return std::nullopt;
    bytes.resize(static_cast<std::size_t>(got));
    return bytes;
  }

private:
  UniqueFd socket_;
  publish::OscTarget target_;
  bool is_bound_ = false;
};

struct OscMessage {
  std::string address, types, text;
  std::vector<std::int32_t> whole;
  std::vector<float> numbers;
};

/// Reads from the front of a datagram. What does not fit is a failure of the test.
class OscReader {
public:
  explicit OscReader(std::string_view bytes) : bytes_(bytes) {}

  bool has_ended() const { return bytes_.empty(); }
  std::uint32_t u32() {
    REQUIRE(bytes_.size() >= 4);
    std::uint32_t number = 0;
    for (int at = 0; at < 4; ++at)
      number = number << 8U | static_cast<std::uint8_t>(bytes_[static_cast<std::size_t>(at)]);
    bytes_.remove_prefix(4);
    return number;
  }
  std::string text() {
    const std::size_t length = bytes_.find('\0');
    REQUIRE(length != std::string_view::npos);
    const std::size_t padded = length / 4 * 4 + 4;
    REQUIRE(padded <= bytes_.size());
    std::string text(bytes_.substr(0, length));
    for (std::size_t at = length; at < padded; ++at)
      CHECK(bytes_[at] == '\0');
    bytes_.remove_prefix(padded);
    return text;
  }
  OscMessage message() {
    OscMessage message;
    message.address = text();
    const std::string types = text();
    REQUIRE(types.starts_with(","));
    message.types = types.substr(1);
    for (const char type : message.types) {
      if (type == 'f') message.numbers.push_back(std::bit_cast<float>(u32()));
      if (type == 'i') message.whole.push_back(static_cast<std::int32_t>(u32()));
      if (type == 's') message.text = text();
      REQUIRE((type == 'f' || type == 'i' || type == 's'));
    }
    CHECK(has_ended());
    return message;
  }
  std::string_view part(std::size_t length) {
    REQUIRE(length % 4 == 0);
    REQUIRE(length <= bytes_.size());
    const std::string_view part = bytes_.substr(0, length);
    bytes_.remove_prefix(length);
    return part;
  }

private:
  std::string_view bytes_;
};

/// Returns the messages of a bundle that is to be executed at once.
inline std::vector<OscMessage> messages_in(const std::string& datagram) {
  REQUIRE(datagram.size() <= 1200);
  OscReader reader(datagram);
  REQUIRE(reader.text() == "#bundle");
  CHECK(reader.u32() == 0);
  CHECK(reader.u32() == 1);
  std::vector<OscMessage> messages;
  while (!reader.has_ended()) {
    const std::uint32_t length = reader.u32();
    messages.push_back(OscReader(reader.part(length)).message());
  }
  return messages;
}

} // namespace nendo::test
