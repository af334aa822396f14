#pragma once
// The server's address and port, in the form of --web, [ADDR:]PORT, and its sockets.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>

namespace nendo::web {

struct Endpoint {
  std::string address = "127.0.0.1"; ///< numeric IPv4 or IPv6 address, without brackets
  std::uint16_t port = 0;            ///< 0: the system chooses a free port

  bool is_ipv6() const noexcept { return address.find(':') != std::string::npos; }
  /// Returns address and port as in a URL, for example "[::1]:8080".
  std::string authority() const;
};

/// Parses "8080", "127.0.0.1:8080" or "[::1]:8080". Without an address, only this machine can reach
/// the server. Refuses host names, so that the network of an open port is clear. Error: usage.
Result<Endpoint> parse_endpoint(std::string_view text);

/// Returns whether the host of an authority ("localhost:8080", "[::1]", "192.168.1.5") is a numeric
/// address or localhost. A hostile site can resolve its own name to this machine (DNS rebinding),
/// but none of these.
bool is_address_or_localhost(std::string_view authority);

/// Opens a non-blocking socket that listens at `endpoint`, and writes its port to `endpoint`.
/// Error: failed.
Result<UniqueFd> listen_at(Endpoint& endpoint);
/// Returns the next connection as a non-blocking socket, or nothing if none is waiting.
/// buffer_bytes: the size of its send buffer.
std::optional<UniqueFd> accept_from(const UniqueFd& listener, std::size_t buffer_bytes);

} // namespace nendo::web
