#pragma once
// Rigid motions: that of clay that lies on nothing, which follows the bodies that stick to it and
// evades those that press it, and those between two frames. All lengths are in a layout's
// coordinates.

#include <span>

#include <Eigen/Geometry>

namespace nendo::deform {

/// A place where a body touches the clay.
struct Carrier {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< out of the body; zero: it is held
  Eigen::Vector3d way = Eigen::Vector3d::Zero();    ///< where what touches it has gone
  double depth = 0.0;
  double load = 0.0; ///< which the clay remembers
};

/// Returns the motion that leaves the least sum of squares: of depths, and of tangential ways as
/// far as Coulomb's friction carries. Clay yields: no place resists by more than `yields`. Depths
/// that are left then balance, as forces do. `middle` is the clay's; it turns about this. Finds it
/// by reweighted least squares. Does not allocate.
Eigen::Isometry3d fit_rigid_motion(std::span<const Carrier> carriers, const Eigen::Vector3d& middle,
                                   double friction, double yields) noexcept;

/// Returns to * from^-1. This and the next function are not inlined: each use of Eigen's inverse
/// costs half a second of compilation.
Eigen::Isometry3d motion_between(const Eigen::Isometry3d& from,
                                 const Eigen::Isometry3d& to) noexcept;
/// Returns motion^-1 * point.
Eigen::Vector3d before_motion(const Eigen::Isometry3d& motion,
                              const Eigen::Vector3d& point) noexcept;

} // namespace nendo::deform
