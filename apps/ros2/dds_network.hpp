#pragma once
// Which network DDS uses, by the environment variables of ROS 2.

#include <cstdint>
#include <string>

#include <nendo/base/result.hpp>

namespace nendo::ros2 {

/// The variables; an empty one is as if it were not set.
struct Environment {
  std::string domain_id;       ///< ROS_DOMAIN_ID
  std::string localhost_only;  ///< ROS_LOCALHOST_ONLY
  std::string discovery_range; ///< ROS_AUTOMATIC_DISCOVERY_RANGE
  std::string static_peers;    ///< ROS_STATIC_PEERS
  std::string cyclonedds_uri;  ///< CYCLONEDDS_URI
};

/// Reads the variables of this process.
Environment environment();

struct DdsNetwork {
  std::uint32_t domain_id = 0;
  /// DDS must neither send to other machines nor receive from them (hold_to_this_machine()).
  bool is_this_machine_only = true;
  std::string config; ///< the argument of dds_create_domain(), which ends with CYCLONEDDS_URI
};

/// Decides by the environment. ROS itself reaches the subnet by default; this stays on the machine
/// until the environment says SUBNET, SYSTEM_DEFAULT, or has peers. `has_multicast`: an interface
/// other than the loopback is up. Errors: usage.
Result<DdsNetwork> network_of(const Environment& environment, bool has_multicast);

} // namespace nendo::ros2
