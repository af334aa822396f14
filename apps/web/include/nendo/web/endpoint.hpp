#pragma once
// Where a server listens: [ADDR:]PORT, as --web takes it.

#include <cstdint>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::web {

struct Endpoint {
  std::string address = "127.0.0.1"; ///< IPv4 or IPv6 in figures, without brackets
  std::uint16_t port = 0;            ///< 0: whichever is free

  bool is_ipv6() const noexcept { return address.find(':') != std::string::npos; }
  /// As a browser takes it: "[::1]:8080".
  std::string authority() const;
};

/// "8080", "127.0.0.1:8080", "[::1]:8080": without an address, this machine's own browsers alone. A
/// name is no address: whoever opens a port to a network says to which. Error: usage.
Result<Endpoint> parse_endpoint(std::string_view text);

/// Whether the host of an authority ("localhost:8080", "[::1]", "192.168.1.5") is an address in
/// figures or localhost. A page of somebody else's can have its own name lead here (DNS rebinding),
/// but neither of those.
bool is_address_or_localhost(std::string_view authority);

} // namespace nendo::web
