#pragma once
// The faces of a part that another part crosses, triangulated again so that the crossings are
// edges.

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "join/crossings.hpp"
#include "join/triangle_surface.hpp"

namespace nendo::deform {

/// All faces of a part: those that are not crossed, in their order, then the pieces of the others.
/// Points have the part's numbers; crossing c has the number c + the part's points.
struct PartPieces {
  std::vector<Corners> faces;
  std::vector<std::uint32_t> from; ///< which face each piece is of
  std::size_t whole = 0;           ///< so many are not crossed
};

/// Returns false if some face cannot be triangulated: crossings coincide, or segments cross each
/// other, after rounding.
bool cut_faces(const CrossedPart& part, std::uint32_t number, const Crossings& crossings,
               PartPieces& pieces);

} // namespace nendo::deform
