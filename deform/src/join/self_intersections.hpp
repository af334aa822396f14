#pragma once
// Whether a surface of triangles meets itself, decided exactly.

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/space.hpp"

namespace nendo::deform {

using TrianglePair = std::pair<std::uint32_t, std::uint32_t>; ///< the lesser number first

/// Returns the pairs of triangles that meet (triangle_meeting.hpp), sorted, and a triangle without
/// area as a pair with itself. It stops when it has found `most`. Places must be finite; for their
/// size see exact_predicates.hpp. Allocates.
std::vector<TrianglePair> self_intersections(std::span<const SpacePoint> places,
                                             std::span<const Corners> triangles,
                                             std::size_t most = SIZE_MAX);

/// The same, only of pairs of which one triangle at least is in `changed`: enough where the others
/// were free of intersections before.
std::vector<TrianglePair> self_intersections_of(std::span<const SpacePoint> places,
                                                std::span<const Corners> triangles,
                                                std::span<const std::uint32_t> changed,
                                                std::size_t most = SIZE_MAX);

/// Only pairs of one in `some` and one in `others`. Triangles without area are not looked for.
std::vector<TrianglePair> intersections_between(std::span<const SpacePoint> places,
                                                std::span<const Corners> triangles,
                                                std::span<const std::uint32_t> some,
                                                std::span<const std::uint32_t> others,
                                                std::size_t most = SIZE_MAX);

} // namespace nendo::deform
