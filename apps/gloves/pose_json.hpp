#pragma once
// A hand's pose as a line of JSON, as `nendo poses` prints it.

#include <optional>
#include <string>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::gloves {

/// Returns one object without a line end. Its keys are time_s (host clock), hand ("left" or
/// "right") and joints. joints has OpenXR's names in OpenXR's order, each with position_m [x, y, z]
/// and orientation_xyzw, a unit quaternion whose w is not negative. With `sensors` there is also
/// the key angles, with what angle_sources_json() returns.
std::string pose_json(HostTime time, Side side, const hand::HandPose& pose,
                      std::optional<SensorMask> sensors = std::nullopt);

} // namespace nendo::gloves
