#pragma once
// Turns models between files whose z is up and Nendo, whose y is up. Both ways are exact.

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Turns points of a file whose z is up, in place.
inline void lay_from_z_up(Points& points) {
  points.row(1).swap(points.row(2));
  points.row(2).array() = 0.0 - points.row(2).array(); // no -0
}

/// Turns points back as they are in that file.
inline void lay_z_up(Points& points) {
  points.row(2).array() = 0.0 - points.row(2).array(); // no -0
  points.row(1).swap(points.row(2));
}

} // namespace nendo::deform
