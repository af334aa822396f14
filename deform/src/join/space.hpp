#pragma once
// Points in space and triangles between them, as plain numbers: what joining computes with.

#include <array>
#include <cmath>
#include <cstdint>

#include "cut/exact_predicates.hpp"

namespace nendo::deform {

using Corners = std::array<std::uint32_t, 3>; ///< vertices, counter-clockwise seen from outside

inline SpacePoint operator+(const SpacePoint& a, const SpacePoint& b) noexcept {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline SpacePoint operator-(const SpacePoint& a, const SpacePoint& b) noexcept {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline SpacePoint operator*(double s, const SpacePoint& a) noexcept {
  return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const SpacePoint& a, const SpacePoint& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline SpacePoint cross(const SpacePoint& a, const SpacePoint& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const SpacePoint& a) noexcept {
  return std::sqrt(dot(a, a));
}
inline double distance(const SpacePoint& a, const SpacePoint& b) noexcept {
  return length(b - a);
}

/// Twice the triangle's area vector.
inline SpacePoint area_vector(const SpacePoint& a, const SpacePoint& b,
                              const SpacePoint& c) noexcept {
  return cross(b - a, c - a);
}

} // namespace nendo::deform
