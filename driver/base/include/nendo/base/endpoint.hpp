#pragma once
// A numeric address of the network and a port. Names are never looked up, so that it is clear which
// network a port is open to.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <netinet/in.h>
#include <sys/socket.h>

#include <nendo/base/api.hpp>
#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>

namespace nendo {

/// An address and a port as the system's calls take them.
struct SocketAddress {
  union {
    sockaddr_storage whole; ///< all zeros at first
    sockaddr any;
    sockaddr_in v4;
    sockaddr_in6 v6;
  } address{};
  socklen_t length = 0;
};
/// Returns true for the same family, address and port.
NENDO_API bool operator==(const SocketAddress& one, const SocketAddress& other) noexcept;

struct NENDO_API Endpoint {
  std::string address =
      "127.0.0.1"; ///< numeric IPv4 or IPv6, without brackets; of IPv6 perhaps with a zone
  std::uint16_t port = 0;

  bool is_ipv6() const noexcept { return address.find(':') != std::string::npos; }
  /// Returns ADDRESS:PORT, or [ADDRESS]:PORT.
  std::string authority() const;
  /// Returns zeros if the address is not numeric.
  SocketAddress socket_address() const;
};

/// Returns the endpoint of an address of IPv4 or IPv6.
NENDO_API Endpoint endpoint_of(const SocketAddress& address);

/// What parse_endpoint() takes, for error messages.
inline constexpr std::string_view endpoint_rule =
    "use PORT or ADDRESS:PORT, with a numeric address and a port of 1 to 65535, as 9000, "
    "192.168.1.5:9000 or [::1]:9000";

/// Parses "9000", which is a port of this machine only, "192.168.1.5:9000" or "[::1]:9000".
/// min_port: 0 where the system may choose the port. Error: usage, with endpoint_rule as its
/// message.
NENDO_API Result<Endpoint> parse_endpoint(std::string_view text, std::uint16_t min_port = 1);

/// Opens a non-blocking socket of this type, SOCK_STREAM or SOCK_DGRAM, binds it to the endpoint,
/// and listens if it is a stream. Port 0 is replaced by the port that the system chose. [::] does
/// not include IPv4. Errors: failed (in use, no address of this machine), no_permission (a port
/// below 1024); the message begins with the endpoint.
NENDO_API Result<UniqueFd> open_at(Endpoint& endpoint, int type);

/// Returns the next connection as a non-blocking socket, whose bytes leave at once, or nothing if
/// none is waiting. send_buffer_bytes: the size of its send buffer.
NENDO_API std::optional<UniqueFd> accept_from(const UniqueFd& listener,
                                              std::size_t send_buffer_bytes);

/// Returns such a socket that is connected to the address, or will be; nothing if there is no way
/// there.
NENDO_API std::optional<UniqueFd> begin_to_connect(const SocketAddress& to,
                                                   std::size_t send_buffer_bytes);

} // namespace nendo
