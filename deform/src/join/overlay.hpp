#pragma once
// Two closed surfaces laid over each other: each is cut along the other, and of each piece it is
// known whether it is inside of the other one. Union and intersection are then choices of pieces.
//
// Points of crossings are named by edge and face, and all signs are exact, so what is chosen is
// closed whatever rounding does. The second surface is displaced by 1e-7 of its size from
// the first attempt on, so that no position is special.

#include <array>
#include <cstdint>
#include <vector>

#include <nendo/base/result.hpp>

#include "join/crossings.hpp"
#include "join/triangle_surface.hpp"

namespace nendo::deform {

/// All faces of a part: those that are not crossed, in their order, then the pieces of the others.
/// Points have the part's numbers; crossing c has the number c + the part's points.
struct PartPieces {
  std::vector<Corners> faces;
  std::vector<std::uint32_t> from; ///< the face of each piece
  std::size_t whole = 0;           ///< the number of faces that are not crossed
};

struct Overlay {
  std::vector<SpacePoint> second_points; ///< points of the displaced second surface
  Crossings crossings;
  std::array<PartPieces, 2> pieces;
  std::array<std::vector<char>, 2> inside; ///< whether each piece is in the other surface
  int attempts = 0;
};

/// Which pieces are chosen.
enum class Choice { union_of_both, intersection };

/// What was chosen, as a surface. Its points keep their order: the first surface's, the second
/// one's, then crossings.
struct Chosen {
  TriangleSurface surface;
  /// Where each point is from: its number in the first surface, or that in the second plus the
  /// first one's points, or that of the crossing plus both.
  std::vector<std::uint32_t> origins;
  std::vector<std::uint32_t> face_parts; ///< each face's part: 0 or 1
  std::vector<std::uint32_t> made;       ///< faces that are pieces of crossed ones
};

/// Surfaces must be closed, face outwards and be free of self-intersections; otherwise the result
/// need not be what one expects. `first_attempt` > 0 leaves out as many displacements. Error:
/// failed (no displacement led to general position). Allocates, blocks.
Result<Overlay> overlay(const TriangleSurface& first, const TriangleSurface& second,
                        int first_attempt = 0);
inline constexpr int max_overlay_attempts = 8;

/// Allocates.
Chosen choose(const TriangleSurface& first, const TriangleSurface& second, const Overlay& overlay,
              Choice choice);

} // namespace nendo::deform
