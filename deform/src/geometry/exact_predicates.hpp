#pragma once
// On which side a point lies, decided without error: signs of determinants of coordinates as they
// are in the mesh. Most calls end at a filter in plain doubles; the others are summed as
// expansions (J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast robust
// geometric predicates, 1997).
//
// Coordinates and their differences must be 0 or between 1e-70 and 1e70 in size, so that no product
// overflows or loses digits. No function allocates or blocks.

#include <array>

namespace nendo::deform {

using PlanePoint = std::array<double, 2>;
using SpacePoint = std::array<double, 3>;

/// Returns 1 if a, b, c turn to the left (counter-clockwise), -1 to the right, 0 if they lie on one
/// line.
int orient_2d(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) noexcept;

/// Returns 1 if d lies inside the circle through a, b, c, -1 outside of it, 0 on it. The three must
/// turn to the left.
int in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
              const PlanePoint& d) noexcept;

/// Returns 1 if d lies on the side of the plane from which a, b, c turn to the right (below, if
/// they turn to the left seen from above), -1 on the other side, 0 in the plane.
int orient_3d(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
              const SpacePoint& d) noexcept;

/// Returns 1 if a, b, c turn to the left, seen from where `normal` points to, -1 to the right, 0 if
/// they lie on one line for such an observer. The normal's largest coordinate must be between 0.1
/// and 10 in size.
int turn_about(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
               const SpacePoint& normal) noexcept;

} // namespace nendo::deform
