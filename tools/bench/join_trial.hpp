#pragma once
// How long it takes to join two balls, part by part.

#include <cstddef>

namespace nendo::bench {

struct JoinTrial {
  std::size_t triangles = 0; ///< triangles of each ball
  std::size_t crossings = 0;
  double sharp_ms = 0.0;     ///< the best of the runs
  double smeared_ms = 0.0;   ///< with a seam of a tenth of the radius
  double volume_error = 0.0; ///< |V(union) - exact|, relative; the exact one is that of the balls'
                             ///< lens, so it is the balls' coarseness that shows
  bool fine = false;         ///< both results were handed out
};

/// Joins two balls of radius 1 that lie 1 apart and have texture coordinates, colours and
/// materials. `rings` is the number of rings of vertices, each of twice as many.
JoinTrial measure_join(std::size_t rings, int runs);

} // namespace nendo::bench
