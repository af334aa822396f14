#pragma once
// Which tracker of which VRPN server a specification names.

#include <cstdint>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/device_spec.hpp>
#include <nendo/driver/vrpn_protocol.hpp>

namespace nendo::driver::vrpn {

struct Place {
  std::string tracker; ///< its name at the server
  std::string host;    ///< a name, or an address without brackets
  std::uint16_t port = default_port;
};

/// Splits the target NAME@HOST[:PORT], where HOST may be an address of IPv6 in brackets. Error:
/// usage.
Result<Place> parse_place(const DeviceSpec& spec);

} // namespace nendo::driver::vrpn
