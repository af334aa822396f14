#pragma once
// Whether triangles of a surface meet elsewhere than at the corners and edges that they share.
// Decided exactly.

#include <span>

#include "geometry/space.hpp"

namespace nendo::deform {

/// Returns true if two triangles have a point in common that is none of a shared corner's or
/// edge's. Corners are shared if their numbers are the same. Neither may have a corner twice.
bool triangles_meet(std::span<const SpacePoint> points, const Corners& one,
                    const Corners& other) noexcept;

/// Returns true if the three places are in line, exactly.
bool is_degenerate(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) noexcept;

} // namespace nendo::deform
