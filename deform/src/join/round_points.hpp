#pragma once

#include <span>

#include <Eigen/Core>

#include "geometry/space.hpp"

namespace nendo::deform {

/// Rounds points to the nearest floats, and returns these.
Eigen::Matrix3Xf round_points(std::span<SpacePoint> points);

} // namespace nendo::deform
