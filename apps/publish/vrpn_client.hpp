#pragma once
// A client of the VRPN server: its connection, what it said, and what waits to be sent. No call
// blocks.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/base/endpoint.hpp>
#include <nendo/base/unique_fd.hpp>
#include <nendo/base/units.hpp>

#include "publish/vrpn_messages.hpp"
#include "publish/vrpn_requests.hpp"

namespace nendo::publish::vrpn {

class Client {
public:
  /// `socket` is non-blocking, and connected or connecting. asked_for: where a client listens that
  /// asked to be connected to.
  Client(UniqueFd socket, HostTime now, const SocketAddress& asked_for = {});

  int fd() const noexcept { return socket_.get(); }
  const SocketAddress& asked_for() const noexcept { return asked_for_; }
  short events() const noexcept; ///< the events for poll()
  /// Handles what poll() reports: reads requests, answers them, and sends what waits.
  void serve(short events);
  /// Sends the hands: `hands` as append_hands() makes them, and the switches that have changed. A
  /// client that has not taken the last ones misses these.
  void offer(const Bytes& hands, const HandsRecord& record, std::int64_t time_us, HostTime now);
  /// Returns whether the connection has ended, so that it can be destroyed: by the client, by a
  /// message that is none of VRPN 7, or because the client said or took nothing for some seconds.
  bool is_over(HostTime now) const noexcept;
  /// Returns how many records it has missed.
  std::uint64_t missed() const noexcept { return missed_; }

private:
  void receive();
  void flush();

  UniqueFd socket_;
  SocketAddress asked_for_;
  Requests requests_;
  Bytes waiting_;                               ///< that the system has not taken yet
  std::array<std::optional<bool>, 2> switches_; ///< that the client knows
  HostTime stalled_since_;                      ///< or since it has not greeted
  std::uint64_t missed_ = 0;
  bool is_named_ = false; ///< the names have been sent
  bool is_gone_ = false;
};

} // namespace nendo::publish::vrpn
