#pragma once
// A VRPN server for hands. It has no thread: one thread calls it, about once a millisecond.

#include <cstddef>
#include <cstdint>
#include <list>
#include <vector>

#include <poll.h>

#include <nendo/base/endpoint.hpp>
#include <nendo/base/result.hpp>

#include "publish/vrpn_client.hpp"

namespace nendo::publish::vrpn {

inline constexpr std::size_t max_clients = 16;

struct ServerCounts {
  std::uint64_t clients = 0; ///< that have connected, or to which the server has connected
  std::uint64_t refused = 0; ///< connections beyond max_clients
  std::uint64_t missed = 0;  ///< records that clients missed because they read too slowly
};

class Server {
public:
  /// Listens at the endpoint by TCP, and by UDP for clients that ask to be connected to. Port 0:
  /// one that the system chooses. Errors: those of open_at().
  static Result<Server> open(Endpoint endpoint);

  const Endpoint& endpoint() const noexcept { return endpoint_; }
  /// Accepts clients, answers them, sends what waits, and drops those that have gone.
  void serve();
  /// Sends the hands to all clients.
  void send(const HandsRecord& record);
  /// Returns the counts since open().
  ServerCounts counts() const;

private:
  Server(Endpoint endpoint, UniqueFd listener, UniqueFd asked);
  void accept_new(HostTime now);
  void connect_to_asking(HostTime now);
  bool is_client(const SocketAddress& address) const;

  Endpoint endpoint_;
  UniqueFd listener_;
  UniqueFd asked_; ///< datagrams of clients that want a connection
  std::list<Client> clients_;
  std::vector<pollfd> polled_;
  ServerCounts counts_;
};

/// Returns the port that a client's datagram asks to be connected to; 0 if it is none, or a port
/// below 1024. The address in it is not used.
std::uint16_t asked_port(std::span<const std::byte> datagram) noexcept;

} // namespace nendo::publish::vrpn
