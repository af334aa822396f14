#pragma once
// Where a surface is thinner than its edges should be.

#include <vector>

#include "topology/thin_surface.hpp"

namespace nendo::deform {

/// Three points whose edges bound no face, or two whose sheets are near each other.
struct ThinPlace {
  enum class Kind : std::uint8_t { neck, wall, gap };
  Kind kind = Kind::neck;
  Triple points{};    ///< the third is the second again where there are two
  double size = 0.0;  ///< in edges
  bool begins = true; ///< a change; else it only belongs to one that a thinner place begins
};

/// Returns them, the thinnest first. Allocates.
std::vector<ThinPlace> thin_places(const ThinSurface& surface);

} // namespace nendo::deform
