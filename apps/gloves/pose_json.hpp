#pragma once
// A hand's pose as a line of JSON, as `nendo poses` prints it.

#include <optional>
#include <string>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::gloves {

/// One object without a line end. Keys: time_s (host clock), hand ("left" or "right"), joints: by
/// OpenXR's names and in its order, position_m [x, y, z] and orientation_xyzw, a unit quaternion
/// whose w is not negative. With `sensors` also angles, as angle_sources_json() has them.
std::string pose_json(HostTime time, Side side, const hand::HandPose& pose,
                      std::optional<SensorMask> sensors = std::nullopt);

} // namespace nendo::gloves
