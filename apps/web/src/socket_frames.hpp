#pragma once
// Frames of a WebSocket (RFC 6455, section 5): a client's, as they come in, and the heads of the
// server's. Pure. A message's bytes are handed over in a string of their own.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace nendo::web {

/// What a client may say at once: the name of a button is far less.
inline constexpr std::size_t most_client_message = 1024;

enum class Opcode : std::uint8_t {
  continuation = 0,
  text = 1,
  binary = 2,
  close = 8,
  ping = 9,
  pong = 10,
};

/// Section 7.4.1.
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
    nothing, ///< more bytes are needed
    text,
    binary,
    ping,
    pong,
    close,
    fault, ///< the connection is to be closed with `code`
  };
  Kind kind = Kind::nothing;
  std::string payload{}; ///< at most most_client_message
  CloseCode code = CloseCode::protocol_error;
};

/// Puts messages together of what one client sends.
class ClientReader {
public:
  /// Takes the first whole frame off `bytes`, and goes on until there is an event or no whole
  /// frame. After a fault there are no more events.
  ClientEvent next(std::string& bytes);
  /// How many bytes may wait for the rest of their frame.
  static constexpr std::size_t most_pending = most_client_message + 14;

private:
  struct Head;
  ClientEvent fault(CloseCode code);
  ClientEvent take(const Head& head, std::string payload);

  std::string parts_;                  ///< of a message that is not complete
  Opcode kind_ = Opcode::continuation; ///< its kind; continuation: there is none
  bool failed_ = false;
};

/// Of a whole, unmasked message of that length: what stands before its bytes.
std::string server_head(Opcode opcode, std::uint64_t length);
/// A whole control frame; payload: at most 125 bytes.
std::string control_frame(Opcode opcode, std::string_view payload);
std::string close_frame(CloseCode code);

} // namespace nendo::web
