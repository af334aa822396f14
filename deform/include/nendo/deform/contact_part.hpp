#pragma once
// The bodies that press clay, made of rounded cones and rounded triangles.

#include <array>
#include <cstddef>

#include <Eigen/Geometry>

namespace nendo::deform {

/// The convex hull of two balls (a rounded cone) or of three (a rounded triangle); model units.
struct ContactPart {
  std::array<Eigen::Vector3d, 3> corners{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                         Eigen::Vector3d::Zero()}; ///< the balls' centres
  std::array<double, 3> radii{};                                   ///< > 0
  std::size_t corner_count = 2;                                    ///< 2 or 3
  /// The frame of the part's surface: clay that sticks to the part follows the frame.
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
};

} // namespace nendo::deform
