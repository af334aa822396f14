#pragma once
// A Transport that receives datagrams of UDP, one per read, from any sender.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

#include "transport/transport.hpp"

namespace nendo::driver {

/// Where to listen. The default is reached by programs of this machine only.
struct UdpEndpoint {
  std::string address = "127.0.0.1"; ///< numeric, IPv4 or IPv6, without brackets
  std::uint16_t port = 0;
};

/// Parses `PORT`, `ADDRESS:PORT` or `[IPV6]:PORT` with a numeric address. Looks up no name. Error:
/// usage, in a message without the text.
Result<UdpEndpoint> parse_udp_endpoint(std::string_view text);

/// Returns `ADDRESS:PORT` or `[IPV6]:PORT`.
std::string to_string(const UdpEndpoint& endpoint);

/// The largest number of datagrams that are read per second. The system drops what its buffer
/// cannot hold, so that a flood does not take a processor. Two hands at 240 Hz, with two messages
/// for each pose, are 960.
inline constexpr int max_datagrams_per_s = 3200;

/// Listens at `endpoint`. read_some() returns one whole datagram in one call, or its beginning if
/// the buffer is shorter; empty ones are skipped. write_all() does nothing and returns `timeout`.
/// Errors: no_device (in use, not an address of this machine), no_permission (a port below 1024).
Result<std::unique_ptr<Transport>> open_udp(const UdpEndpoint& endpoint);

} // namespace nendo::driver
