#pragma once
// Keeps the sockets of DDS to this machine, by the kernel.

#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::ros2 {

/// Returns whether an interface is up that multicasts over IPv4, other than the loopback.
bool has_multicast();

/// Returns the descriptors of this process that are sockets.
std::vector<int> open_sockets();

/// Makes sure that each socket of this process, except those in `others`, neither sends to another
/// machine nor receives from one: a filter drops what did not come from this machine, unicast goes
/// to the loopback, and multicast has a time to live of 0. Errors: usage (a socket that is not of
/// UDP over IPv4); failed.
Result<void> hold_to_this_machine(const std::vector<int>& others);

} // namespace nendo::ros2
