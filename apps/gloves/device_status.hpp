#pragma once
// What windows and pages show of the devices of a run: of each glove, and of each station of a
// tracker that moves a wrist.

#include <array>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/units.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/sculpting/open_hand.hpp>

#include "gloves/count_rate.hpp"

namespace nendo::gloves {

using sculpting::OpenHand;

/// Two lines of printable ASCII about a device.
struct DeviceStatus {
  std::string title; ///< "left glove: serial:/dev/ttyUSB0: CyberGlove, 22 sensors"
  std::string state; ///< "90.0/s, 8 ms old, 359 delivered, nothing lost"
};
/// The devices of each hand, by flow::Placement::index_of(side): its glove, then its tracker. A
/// glove of which only a recording is played has an empty state.
using DeviceStatuses = std::array<std::vector<DeviceStatus>, 2>;

/// Watches the devices of a run, by its frames. One thread.
class DeviceWatch {
public:
  /// Returns what they are and do at `now`, when `frame` is the latest one. Call it some times per
  /// second. Thread-safe with the loop and the readers of the devices.
  DeviceStatuses look(std::span<const OpenHand> hands, const flow::Frame& frame, HostTime now);

private:
  std::array<CountRate, 2> pose_rates_; ///< rates of good poses, by flow::Placement::index_of(side)
};

} // namespace nendo::gloves
