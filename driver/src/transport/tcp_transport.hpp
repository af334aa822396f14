#pragma once
// Connections to a server by TCP over IPv4 or IPv6, as Transports.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <nendo/base/endpoint.hpp>
#include <nendo/base/result.hpp>

#include "transport/transport.hpp"

namespace nendo::driver {

/// Connects to one server, again after each loss. One thread at a time uses it, as it uses the
/// transports, see transport_of_socket(). What is sent leaves at once (TCP_NODELAY). A server that
/// confirms nothing for two seconds is gone.
class TcpConnector {
public:
  /// `host` is a name, or an address without brackets.
  TcpConnector(std::string host, std::uint16_t port);

  /// Looks the name up, the first time only, for 1 s at most, and connects: to each address of it
  /// in turn, for 1 s in all the first time, and 0.5 s later. Error: no_device, one line that names
  /// the host and the remedy.
  Result<std::unique_ptr<Transport>> connect();
  /// Returns the number of connections so far, which changes with each new one.
  std::uint64_t connections() const noexcept { return connections_; }
  /// Returns "host:port" for messages.
  std::string name() const;

private:
  const std::string host_;
  const std::uint16_t port_;
  std::vector<SocketAddress> addresses_; ///< empty until the name was found
  std::uint64_t connections_ = 0;
};

} // namespace nendo::driver
