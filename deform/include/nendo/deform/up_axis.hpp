#pragma once
// Converts between z-up files and Nendo's y-up coordinates. Both directions are exact.

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Rotates z-up points to y-up, in place.
inline void lay_from_z_up(Points& points) {
  points.row(1).swap(points.row(2));
  points.row(2).array() = 0.0 - points.row(2).array(); // no -0
}

/// Rotates y-up points to z-up, in place.
inline void lay_z_up(Points& points) {
  points.row(2).array() = 0.0 - points.row(2).array(); // no -0
  points.row(1).swap(points.row(2));
}

} // namespace nendo::deform
