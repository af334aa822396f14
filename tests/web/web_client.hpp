#pragma once
// The other end of a connection to the server: plain sockets, frames written from RFC 6455.

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <nendo/base/unique_fd.hpp>

#include "web/server.hpp"

namespace nendo::test {

struct Answer {
  int status = 0; ///< 0: none came
  std::string head, body;
};

/// A frame as a client sends it, written from RFC 6455, section 5.2. first: its first byte.
inline std::string client_frame(unsigned first, const std::string& payload, bool masked = true) {
  const std::string mask = "\x37\xFA\x21\x3D";
  std::string frame(1, static_cast<char>(first));
  const auto put = [&](std::size_t value, int bytes) {
    for (int n = bytes - 1; n >= 0; --n)
      frame += static_cast<char>(value >> (8 * n) & 0xFFU);
  };
  const std::size_t length = payload.size();
  const std::size_t bit = masked ? 128 : 0;
  if (length < 126)
    put(bit | length, 1);
  else if (length < 65536)
    put(bit | 126, 1), put(length, 2);
  else
    put(bit | 127, 1), put(length, 8);
  if (masked) frame += mask;
  for (std::size_t at = 0; at < length; ++at)
    frame += masked ? static_cast<char>(payload[at] ^ mask[at % 4]) : payload[at];
  return frame;
}

class WebClient {
public:
  static constexpr int patience_ms = 20'000;

  explicit WebClient(const web::Server& server, int receive_bytes = 0)
      : WebClient(server.endpoint().port, server.token(), receive_bytes) {}
  WebClient(std::uint16_t port, std::string token, int receive_bytes = 0)
      : authority_("127.0.0.1:" + std::to_string(port)), token_(std::move(token)),
        socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    if (receive_bytes > 0)
      ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ =
        ::connect(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }

  bool send(const std::string& bytes) {
    return connected_ && ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
                             static_cast<ssize_t>(bytes.size());
  }
  /// A request for `path` with these headers besides Host, and its whole answer.
  Answer get(const std::string& path, const std::string& headers = {},
             const std::string& host = {}) {
    send("GET " + path + " HTTP/1.1\r\nHost: " + (host.empty() ? authority_ : host) + "\r\n" +
         headers + "\r\n");
    return answer();
  }
  /// Sends no more, and may still read.
  void end_sending() { ::shutdown(socket_.get(), SHUT_WR); }
  Answer answer() {
    while (receive())
      ;
    return parse_answer();
  }
  std::string with_token(const std::string& path) const { return path + "?token=" + token_; }

  /// As a browser opens a WebSocket; the answer's status.
  int open_socket(const std::string& headers = {}) {
    return open_socket_at("/ws", "Origin: http://" + authority_ + "\r\n" + headers);
  }
  /// As Foxglove's page opens one.
  int open_foxglove(const std::string& protocols = "foxglove.sdk.v1",
                    const std::string& headers = "Origin: https://app.foxglove.dev\r\n") {
    return open_socket_at("/foxglove", "Sec-WebSocket-Protocol: " + protocols + "\r\n" + headers);
  }
  int open_socket_at(const std::string& path, const std::string& headers) {
    send("GET " + with_token(path) + " HTTP/1.1\r\nHost: " + authority_ +
         "\r\nUpgrade: websocket\r\nConnection: keep-alive, Upgrade\r\nSec-WebSocket-Version: 13"
         "\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
         headers + "\r\n");
    while (received_.find("\r\n\r\n") == std::string::npos && receive())
      ;
    const Answer head = parse_answer();
    if (head.status == 101) received_ = head.body;
    protocol = header_of(head.head, "Sec-WebSocket-Protocol");
    accept = head.head.find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") != std::string::npos;
    return head.status;
  }
  bool send_text(const std::string& text) { return send(client_frame(0x81, text)); }
  struct Frame {
    unsigned opcode = 0;
    std::vector<std::byte> payload;
    unsigned close_code() const {
      return payload.size() < 2 ? 0
                                : std::to_integer<unsigned>(payload[0]) << 8U |
                                      std::to_integer<unsigned>(payload[1]);
    }
  };
  /// The next frame; nothing if the connection ends, or none comes for so long.
  std::optional<Frame> next(int wait_ms = patience_ms) {
    for (;;) {
      if (auto frame = take_frame()) return frame;
      if (!receive(wait_ms)) return std::nullopt;
    }
  }
  /// Takes frames until the connection ends; the code of the close frame, or 0 if there was none.
  unsigned close_code() {
    unsigned code = 0;
    while (const auto frame = next())
      if (frame->opcode == 8) code = frame->close_code();
    return code;
  }
  /// Takes at most this number of the bytes that have come, and returns their number.
  std::size_t take(std::size_t most) {
    std::string buffer(most, '\0');
    const ssize_t got = ::recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (got <= 0) return 0;
    received_.append(buffer, 0, static_cast<std::size_t>(got));
    return static_cast<std::size_t>(got);
  }
  /// Reads what is left, and says whether the other side has ended the connection.
  bool is_closed(int wait_ms = patience_ms) {
    while (receive(wait_ms))
      received_.clear();
    return ended_;
  }

  bool accept = false;  ///< the server answered to the key as it must
  std::string protocol; ///< the subprotocol that the server chose; may be empty

private:
  bool receive(int wait_ms = patience_ms) {
    pollfd waiting{socket_.get(), POLLIN, 0};
    if (!connected_ || ::poll(&waiting, 1, wait_ms) != 1) return false;
    char buffer[16384];
    const ssize_t got = ::recv(socket_.get(), buffer, sizeof buffer, 0);
    ended_ = got <= 0;
    if (got > 0) received_.append(buffer, static_cast<std::size_t>(got));
    return got > 0;
  }
  static std::string header_of(const std::string& head, const std::string& name) {
    const auto at = head.find("\r\n" + name + ": ");
    if (at == std::string::npos) return {};
    const std::size_t begin = at + name.size() + 4;
    return head.substr(begin, head.find("\r\n", begin) - begin);
  }
  Answer parse_answer() const {
    const auto end = received_.find("\r\n\r\n");
    if (end == std::string::npos || received_.size() < 12) return {};
    return {std::stoi(received_.substr(9, 3)), received_.substr(0, end + 2),
            received_.substr(end + 4)};
  }
  std::optional<Frame> take_frame() {
    const auto at = [&](std::size_t n) { return static_cast<unsigned char>(received_[n]); };
    if (received_.size() < 2) return std::nullopt;
    std::size_t length = at(1) & 0x7FU;
    const std::size_t more = length == 127 ? 8 : length == 126 ? 2 : 0;
    if (received_.size() < 2 + more) return std::nullopt;
    if (more > 0) length = 0;
    for (std::size_t n = 0; n < more; ++n)
      length = length << 8U | at(2 + n);
    if (received_.size() < 2 + more + length) return std::nullopt;
    Frame frame{at(0) & 0x0FU, std::vector<std::byte>(length)};
    const auto bytes = std::as_bytes(std::span(received_)).subspan(2 + more, length);
    std::copy(bytes.begin(), bytes.end(), frame.payload.begin());
    received_.erase(0, 2 + more + length);
    return frame;
  }

  std::string authority_, token_, received_;
  UniqueFd socket_;
  bool connected_ = false;
  bool ended_ = false;
};

} // namespace nendo::test
