#pragma once
// The fairest shape of a part of a surface whose surroundings stay: a thin plate.

#include <cstdint>
#include <span>
#include <vector>

#include "join/live_surface.hpp"

namespace nendo::deform {

/// Returns places for the free points, such that the sum over them and their neighbours of the
/// squared distances to the mean of each one's neighbours, weighted by 1 / distance, is least.
/// Solved by a sparse Cholesky factorisation: the same bits for the same calls. Allocates.
std::vector<SpacePoint> thin_plate(const LiveSurface& surface, std::span<const std::uint32_t> free);

} // namespace nendo::deform
