#pragma once
// Coarser stand-ins of dense surfaces, for maps that are coarser still.

#include "render/surface.hpp"

namespace nendo::render {

/// Returns whether the sky's light sees a coarser stand-in of the surface.
bool is_dense(const Surface& surface) noexcept;

/// Returns the places and the triangles of a coarser surface: the places in each cube of a grid
/// become their mean, and triangles with two corners in one cube are left out. A closed surface
/// stays closed. There are `cubes` along the longest side of the surface's box. Places that are no
/// numbers, or are far away, are left out with their triangles.
Surface coarse_surface(const Surface& surface, int cubes = 160);

} // namespace nendo::render
