#pragma once
// The union of two surfaces, checked: closed, two-manifold and free of new self-intersections.

#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/base/result.hpp>

#include "join/overlay.hpp"
#include "join/seam.hpp"

namespace nendo::deform {

struct UnionOfTwo {
  TriangleSurface surface;
  std::vector<SeamEdge> seam;
  std::size_t crossings = 0;
  bool swallowed = false; ///< one of both lies wholly inside of the other
};

/// The second surface's points get their bits back where it had to give way only to find a clear
/// position: everywhere but at crossed faces, and where it is as near to the first one as that.
/// Surfaces must be closed and two-manifold. Error: failed (they do not touch, or no union passes
/// the checks). Allocates.
Result<UnionOfTwo> union_of(const TriangleSurface& first, const TriangleSurface& second);

/// Returns true if the surface is closed and two-manifold, and encloses a volume. Allocates.
bool is_closed_solid(const TriangleSurface& surface);

} // namespace nendo::deform
