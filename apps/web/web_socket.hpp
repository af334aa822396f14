#pragma once
// A WebSocket (RFC 6455): the server's part of the handshake (section 4.2.2), which needs SHA-1
// (RFC 3174) and base64 (RFC 4648), a parser for a client's frames (section 5) and the encoding of
// the server's. No secret depends on SHA-1. Does no I/O.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace nendo::web {

using Sha1Digest = std::array<std::byte, 20>;

Sha1Digest sha1(std::span<const std::byte> bytes);
std::string base64(std::span<const std::byte> bytes);
/// Returns whether the text is a Sec-WebSocket-Key, which is 16 bytes in base64.
bool is_socket_key(std::string_view text) noexcept;
/// Returns the Sec-WebSocket-Accept that answers a Sec-WebSocket-Key.
std::string accept_of(std::string_view key);

/// Returns random bytes from the system in hexadecimal digits, for tokens and nonces; empty if the
/// system has none.
std::string random_hex(std::size_t bytes);

/// The max size of a client's message, in bytes. Commands are far shorter.
inline constexpr std::size_t max_client_message = 1024;

enum class Opcode : std::uint8_t {
  continuation = 0,
  text = 1,
  binary = 2,
  close = 8,
  ping = 9,
  pong = 10,
};

/// The codes of RFC 6455, section 7.4.1, and 1012 of IANA's registry.
enum class CloseCode : std::uint16_t {
  normal = 1000,
  going_away = 1001,
  protocol_error = 1002,
  unsupported = 1003,
  policy = 1008,
  too_big = 1009,
  service_restart = 1012,
};

struct ClientEvent {
  enum class Kind {
    nothing, ///< no complete message or control frame yet
    text,
    binary,
    ping,
    pong,
    close,
    fault, ///< a protocol error; the connection must be closed with `code`
  };
  Kind kind = Kind::nothing;
  std::string payload{}; ///< at most max_client_message
  CloseCode code = CloseCode::protocol_error;
};

/// Assembles the messages of one client from its frames.
class ClientReader {
public:
  /// Removes complete frames from the front of `bytes` until one makes an event. After a fault
  /// there are no more events.
  ClientEvent next(std::string& bytes);
  /// The max number of received bytes before a frame is complete.
  static constexpr std::size_t max_pending = max_client_message + 14;

private:
  struct Head;
  ClientEvent fault(CloseCode code);
  ClientEvent take(const Head& head, std::string payload);

  std::string parts_;                  ///< the received part of an incomplete message
  Opcode kind_ = Opcode::continuation; ///< its opcode; `continuation`: no message
  bool failed_ = false;
};

/// Returns the header of an unmasked message in one frame. `length` is the payload's.
std::string server_head(Opcode opcode, std::uint64_t length);
/// Returns a control frame. `payload` may have at most 125 bytes.
std::string control_frame(Opcode opcode, std::string_view payload);
/// `reason` is for users, and is truncated to max_close_reason bytes.
inline constexpr std::size_t max_close_reason = 123;
std::string close_frame(CloseCode code, std::string_view reason = {});

} // namespace nendo::web
