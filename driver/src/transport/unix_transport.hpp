#pragma once
// Connections to a server on this machine by a Unix-domain socket, as Transports.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

#include "transport/transport.hpp"

namespace nendo::driver {

/// Connects to the first of some sockets that a server listens at, again after each loss. One
/// thread at a time uses it, as it uses the transports, see transport_of_socket().
class UnixConnector {
public:
  /// `name` is the server's in messages; `paths` must not be empty.
  UnixConnector(std::string name, std::vector<std::string> paths)
      : name_(std::move(name)), paths_(std::move(paths)) {}

  /// Does not block. Errors: no_device (no server, or one that accepts no more connections),
  /// no_permission; one line that names the server, the sockets and the remedy.
  Result<std::unique_ptr<Transport>> connect();
  /// Returns the number of connections so far, which changes with each new one.
  std::uint64_t connections() const noexcept { return connections_; }
  /// Returns the path of the last connection, or of the first socket.
  const std::string& path() const noexcept { return paths_[connected_]; }

private:
  const std::string name_;
  const std::vector<std::string> paths_;
  std::size_t connected_ = 0; ///< the index of the last connection's path
  std::uint64_t connections_ = 0;
};

} // namespace nendo::driver
