#pragma once
// The seam of a join, from sharp to smeared: the surface near it becomes evenly triangulated, and
// then takes the shape of a thin plate that is clamped where the seam ends.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "join/triangle_surface.hpp"

namespace nendo::deform {

struct Seam {
  TriangleSurface surface;
  std::vector<std::uint32_t> changed; ///< faces that were made again or of which a point moved
  double moved = 0.0;                 ///< the farthest that a point of the seam moved
  /// The volume cannot have changed by more than this: the area of the moved faces, before and
  /// after, times the farthest motion.
  double volume_bound = 0.0;
};

/// An edge by its points.
using SeamEdge = std::pair<std::uint32_t, std::uint32_t>;

/// Smears the seam over `width` > 0, along the surface to each side. Points beyond the width keep
/// their places, bit for bit. The surface must be closed and two-manifold, and is so afterwards;
/// whether it then cuts itself is not looked at. Allocates.
Seam smear_seam(TriangleSurface surface, std::span<const SeamEdge> seam_edges, double width);

} // namespace nendo::deform
