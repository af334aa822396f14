#pragma once
// A Transport that receives datagrams of UDP, one per read, from any sender.

#include <memory>

#include <nendo/base/endpoint.hpp>
#include <nendo/base/result.hpp>

#include "transport/transport.hpp"

namespace nendo::driver {

/// The largest number of datagrams that are read per second. The system drops what its buffer
/// cannot hold, so that a flood does not take a processor. Two hands at 240 Hz, with two messages
/// for each pose, are 960.
inline constexpr int max_datagrams_per_s = 3200;

/// Listens at `endpoint`. read_some() returns one whole datagram in one call, or its beginning if
/// the buffer is shorter; empty ones are skipped. write_all() does nothing and returns `timeout`.
/// Errors: no_device (in use, not an address of this machine), no_permission (a port below 1024).
Result<std::unique_ptr<Transport>> open_udp(Endpoint endpoint);

} // namespace nendo::driver
