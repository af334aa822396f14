#pragma once
// Triangles in space, as plain numbers: what joining computes with.

#include "geometry/space.hpp"

namespace nendo::deform {

inline double distance_between(const SpacePoint& a, const SpacePoint& b) noexcept {
  return length_of(b - a);
}

/// Twice the triangle's area vector.
inline SpacePoint area_vector(const SpacePoint& a, const SpacePoint& b,
                              const SpacePoint& c) noexcept {
  return cross(b - a, c - a);
}

} // namespace nendo::deform
