#pragma once
// The server's part of a WebSocket's handshake (RFC 6455, section 4.2.2). It needs SHA-1 (RFC 3174)
// and base64 (RFC 4648). Nothing secret depends on SHA-1 here.

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

/// Returns random bytes from the system in hexadecimal digits, or an empty string if the system has
/// none. Tokens and nonces are made of them.
std::string random_hex(std::size_t bytes);

} // namespace nendo::web
