#pragma once
// How much of the sky the vertices of surfaces see, and coarser copies of dense surfaces, which
// cast the shadows for it: its maps are coarser still.

#include <span>
#include <vector>

#include "render/depth_map.hpp"
#include "render/surface.hpp"

namespace nendo::render {

/// Returns, for each place of each surface, how much of the sky and of the light that the ground
/// gives back it sees, 0 to about 1. Uses `threads` threads; their number does not change a bit.
std::vector<std::vector<float>> sky_parts(std::span<const Caster> casters,
                                          const std::vector<const Surface*>& surfaces,
                                          unsigned threads);

/// Returns whether the sky's light sees a coarser stand-in of the surface.
bool is_dense(const Surface& surface) noexcept;

/// Returns the places and the triangles of a coarser surface: the places in each cube of a grid
/// become their mean, and triangles with two corners in one cube are left out. A closed surface
/// stays closed. There are `cubes` along the longest side of the surface's box. Places that are no
/// numbers, or are far away, are left out with their triangles.
Surface coarse_surface(const Surface& surface, int cubes = 160);

} // namespace nendo::render
