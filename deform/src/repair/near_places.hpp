#pragma once
// Points that are nearer to each other than a tolerance, as places.

#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns for each point the number of its place: the first of the points before it that lies
/// within the tolerance, among those that are the first of a place, or its own. Only points for
/// which `joins` is not 0 are looked at; all others are their own place. With a tolerance of 0,
/// points must be equal. Allocates.
std::vector<std::uint32_t> near_places(const Points& points, std::span<const std::uint8_t> joins,
                                       double tolerance);

} // namespace nendo::deform
