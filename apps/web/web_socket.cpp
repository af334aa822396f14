#include "web/web_socket.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>
#include <vector>

#include <sys/random.h>

namespace nendo::web {
namespace {

constexpr std::string_view alphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

using State = std::array<std::uint32_t, 5>;

// Appends a bit 1, zeros, and the length in bits, to fill whole blocks of 64 bytes.
std::vector<std::byte> padded(std::span<const std::byte> bytes) {
  std::vector<std::byte> blocks(bytes.begin(), bytes.end());
  blocks.push_back(std::byte{0x80});
  blocks.resize((blocks.size() + 8 + 63) / 64 * 64, std::byte{0});
  std::uint64_t bits = 8 * static_cast<std::uint64_t>(bytes.size());
  for (std::size_t at = blocks.size(); bits > 0; bits >>= 8U)
    blocks[--at] = static_cast<std::byte>(bits & 0xFFU);
  return blocks;
}

void digest_block(std::span<const std::byte> block, State& state) {
  std::array<std::uint32_t, 80> w{};
  for (std::size_t t = 0; t < 16; ++t)
    for (std::size_t n = 0; n < 4; ++n)
      w[t] = w[t] << 8U | std::to_integer<std::uint32_t>(block[4 * t + n]);
  for (std::size_t t = 16; t < w.size(); ++t)
    w[t] = std::rotl(w[t - 3] ^ w[t - 8] ^ w[t - 14] ^ w[t - 16], 1);
  auto [a, b, c, d, e] = state;
  for (std::size_t t = 0; t < w.size(); ++t) {
    std::uint32_t f = b ^ c ^ d;
    std::uint32_t k = t < 40 ? 0x6ED9EBA1U : 0xCA62C1D6U;
    if (t < 20) {
      f = (b & c) | (~b & d);
      k = 0x5A827999U;
    } else if (t >= 40 && t < 60) {
      f = (b & c) | (b & d) | (c & d);
      k = 0x8F1BBCDCU;
    }
    const std::uint32_t next = std::rotl(a, 5) + f + e + w[t] + k;
    e = d;
    d = c;
    c = std::rotl(b, 30);
    b = a;
    a = next;
  }
  const State sums{a, b, c, d, e};
  for (std::size_t n = 0; n < state.size(); ++n)
    state[n] += sums[n];
}

} // namespace

Sha1Digest sha1(std::span<const std::byte> bytes) {
  State state{0x67452301U, 0xEFCDAB89U, 0x98BADCFEU, 0x10325476U, 0xC3D2E1F0U};
  const auto blocks = padded(bytes);
  for (std::size_t at = 0; at < blocks.size(); at += 64)
    digest_block(std::span(blocks).subspan(at, 64), state);
  Sha1Digest digest{};
  for (std::size_t n = 0; n < digest.size(); ++n)
    digest[n] = static_cast<std::byte>(state[n / 4] >> (24 - 8 * (n % 4)) & 0xFFU);
  return digest;
}

std::string base64(std::span<const std::byte> bytes) {
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t word = 0;
    for (std::size_t n = 0; n < 3; ++n)
      word = word << 8U | (n < count ? std::to_integer<std::uint32_t>(bytes[at + n]) : 0U);
    for (std::size_t n = 0; n < 4; ++n)
      text += n <= count ? alphabet[word >> (18 - 6 * n) & 63U] : '=';
  }
  return text;
}

bool is_socket_key(std::string_view text) noexcept {
  // 16 bytes: five groups, and a sixth of one byte, whose second letter has four bits to spare.
  return text.size() == 24 && text.ends_with("==") &&
         text.find_first_not_of(alphabet) == text.size() - 2 && alphabet.find(text[21]) % 16 == 0;
}

std::string accept_of(std::string_view key) {
  const std::string text = std::string(key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
  return base64(sha1(std::as_bytes(std::span(text))));
}

std::string random_hex(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    return {};
  constexpr std::string_view figures = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : random) {
    text += figures[byte >> 4U];
    text += figures[byte & 15U];
  }
  return text;
}

struct ClientReader::Head {
  bool last = false;
  bool reserved = false; ///< bits that only an extension gives a meaning
  bool masked = false;
  std::uint8_t opcode = 0;
  std::uint64_t length = 0;
  std::size_t bytes = 0; ///< length of the head

  bool is_control() const noexcept { return opcode >= 8; }

  // Returns nothing if there are not enough bytes.
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
  if (head.is_control()) { // may come between the parts of a message
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
