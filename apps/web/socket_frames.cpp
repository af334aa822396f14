#include "web/socket_frames.hpp"

#include <array>
#include <optional>
#include <utility>

namespace nendo::web {

struct ClientReader::Head {
  bool last = false;
  bool reserved = false; ///< bits that only an extension gives a meaning
  bool masked = false;
  std::uint8_t opcode = 0;
  std::uint64_t length = 0;
  std::size_t bytes = 0; ///< of the head

  bool is_control() const noexcept { return opcode >= 8; }

  // Nothing if there are not enough bytes to tell.
  static std::optional<Head> parse(std::string_view bytes) noexcept {
    const auto at = [&](std::size_t n) { return static_cast<std::uint8_t>(bytes[n]); };
    if (bytes.size() < 2) return std::nullopt;
    Head head;
    head.last = (at(0) & 0x80U) != 0;
    head.reserved = (at(0) & 0x70U) != 0;
    head.opcode = at(0) & 0x0FU;
    head.masked = (at(1) & 0x80U) != 0;
    head.length = at(1) & 0x7FU;
    const std::size_t more = head.length == 127 ? 8 : head.length == 126 ? 2 : 0;
    head.bytes = 2 + more + (head.masked ? 4 : 0);
    if (bytes.size() < 2 + more) return std::nullopt;
    if (more > 0) head.length = 0;
    for (std::size_t n = 0; n < more; ++n)
      head.length = head.length << 8U | at(2 + n);
    return head;
  }

  std::optional<CloseCode> complaint() const noexcept {
    const bool known = opcode <= 2 || (opcode >= 8 && opcode <= 10);
    if (reserved || !masked || !known) return CloseCode::protocol_error;
    if (is_control() && (!last || length > 125)) return CloseCode::protocol_error;
    if (length > max_client_message) return CloseCode::too_big;
    return std::nullopt;
  }
};

ClientEvent ClientReader::fault(CloseCode code) {
  failed_ = true;
  parts_.clear();
  return {ClientEvent::Kind::fault, {}, code};
}

ClientEvent ClientReader::next(std::string& bytes) {
  while (!failed_) {
    const auto head = Head::parse(bytes);
    if (!head) return {};
    if (const auto code = head->complaint()) return fault(*code);
    const std::size_t length = static_cast<std::size_t>(head->length);
    if (bytes.size() < head->bytes + length) return {};
    std::string payload = bytes.substr(head->bytes, length);
    for (std::size_t at = 0; at < length; ++at)
      payload[at] = static_cast<char>(payload[at] ^ bytes[head->bytes - 4 + at % 4]);
    bytes.erase(0, head->bytes + length);
    auto event = take(*head, std::move(payload));
    if (event.kind != ClientEvent::Kind::nothing) return event;
  }
  return {};
}

ClientEvent ClientReader::take(const Head& head, std::string payload) {
  using Kind = ClientEvent::Kind;
  const auto opcode = static_cast<Opcode>(head.opcode);
  if (head.is_control()) { // may stand between the parts of a message
    const Kind kind = opcode == Opcode::ping   ? Kind::ping
                      : opcode == Opcode::pong ? Kind::pong
                                               : Kind::close;
    return {kind, std::move(payload)};
  }
  const bool goes_on = opcode == Opcode::continuation;
  if (goes_on != (kind_ != Opcode::continuation)) return fault(CloseCode::protocol_error);
  if (!goes_on) kind_ = opcode;
  if (parts_.size() + payload.size() > max_client_message) return fault(CloseCode::too_big);
  parts_ += payload;
  if (!head.last) return {};
  const Kind kind =
      std::exchange(kind_, Opcode::continuation) == Opcode::text ? Kind::text : Kind::binary;
  return {kind, std::exchange(parts_, {})};
}

std::string server_head(Opcode opcode, std::uint64_t length) {
  std::string head(1, static_cast<char>(0x80U | static_cast<unsigned>(opcode)));
  const unsigned more = length > 65535 ? 8 : length > 125 ? 2 : 0;
  head += static_cast<char>(more == 8 ? 127U : more == 2 ? 126U : static_cast<unsigned>(length));
  for (unsigned n = more; n > 0; --n)
    head += static_cast<char>(length >> (8 * (n - 1)) & 0xFFU);
  return head;
}

std::string control_frame(Opcode opcode, std::string_view payload) {
  return server_head(opcode, payload.size()) + std::string(payload);
}

std::string close_frame(CloseCode code, std::string_view reason) {
  const auto number = static_cast<unsigned>(code);
  std::string payload{static_cast<char>(number >> 8U), static_cast<char>(number & 0xFFU)};
  payload += reason.substr(0, max_close_reason);
  return control_frame(Opcode::close, payload);
}

} // namespace nendo::web
