#pragma once
// How much of the sky the vertices of surfaces see.

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

} // namespace nendo::render
