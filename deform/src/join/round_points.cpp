#include "join/round_points.hpp"

namespace nendo::deform {

/// By way of memory: where numbers become floats and doubles again in one expression, GCC 12 makes
/// vectors of that which leave some as they were.
Eigen::Matrix3Xf round_points(std::span<SpacePoint> points) {
  Eigen::Matrix3Xf rounded(3, static_cast<Eigen::Index>(points.size()));
  Eigen::Index column = 0;
  for (const SpacePoint& point : points)
    rounded.col(column++) = Eigen::Vector3d(point[0], point[1], point[2]).cast<float>();
  column = 0;
  for (SpacePoint& point : points) {
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      point[static_cast<std::size_t>(axis)] = static_cast<double>(rounded(axis, column));
    ++column;
  }
  return rounded;
}

} // namespace nendo::deform
