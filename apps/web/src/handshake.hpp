#pragma once
// What the opening of a WebSocket needs (RFC 6455, section 4.2.2): SHA-1 (RFC 3174) and base64 (RFC
// 4648). SHA-1 keeps no secret here; it only shows that both sides speak of the same thing.

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
/// Whether it is what base64() makes of 16 bytes.
bool is_socket_key(std::string_view text) noexcept;
/// Sec-WebSocket-Accept for a Sec-WebSocket-Key.
std::string accept_of(std::string_view key);

} // namespace nendo::web
