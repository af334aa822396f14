#pragma once
// Points and triangles in space as plain numbers, and arithmetic of them, for the code that cuts
// and joins. It works on the coordinates as they are in the mesh.

#include <array>
#include <cmath>
#include <cstdint>

#include "geometry/exact_predicates.hpp"

namespace nendo::deform {

using Corners = std::array<std::uint32_t, 3>; ///< points, counter-clockwise seen from outside

inline SpacePoint operator+(const SpacePoint& a, const SpacePoint& b) noexcept {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline SpacePoint operator-(const SpacePoint& a, const SpacePoint& b) noexcept {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline SpacePoint operator*(double factor, const SpacePoint& a) noexcept {
  return {factor * a[0], factor * a[1], factor * a[2]};
}
inline double dot(const SpacePoint& a, const SpacePoint& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline SpacePoint cross(const SpacePoint& a, const SpacePoint& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length_of(const SpacePoint& a) noexcept {
  return std::sqrt(dot(a, a));
}
/// Returns a vector of length 1, or zero for zero.
inline SpacePoint unit_of(const SpacePoint& a) noexcept {
  const double length = length_of(a);
  return length > 0.0 ? (1.0 / length) * a : SpacePoint{};
}
/// Returns the point a part of the way from one to another.
inline SpacePoint between(const SpacePoint& from, const SpacePoint& to, double part) noexcept {
  return (1.0 - part) * from + part * to;
}
/// Returns a unit vector square to a unit vector.
inline SpacePoint square_to(const SpacePoint& a) noexcept {
  // The axis that it is most square to.
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(a[k]) < std::abs(a[axis])) axis = k;
  SpacePoint other{};
  other[axis] = 1.0;
  return unit_of(cross(a, other));
}

inline double distance_between(const SpacePoint& a, const SpacePoint& b) noexcept {
  return length_of(b - a);
}

/// Twice the triangle's area vector.
inline SpacePoint area_vector(const SpacePoint& a, const SpacePoint& b,
                              const SpacePoint& c) noexcept {
  return cross(b - a, c - a);
}

} // namespace nendo::deform
