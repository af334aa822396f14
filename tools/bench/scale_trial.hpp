#pragma once
// Measures how the deformation's cost grows with the vertices, up to ten millions of them, and with
// the control points, up to a thousand. Times are the thread's processor time, the best of many.

#include <cstddef>

namespace nendo::bench {

/// The times with ten supports that each reach a fifth of the model.
struct GrowthTimes {
  std::size_t vertices = 0;
  std::size_t influences = 0; ///< vertices within a support, summed over supports
  double type1_us = 0.0;      ///< evaluated: weights of so many vertices leave the caches
  double type2_us = 0.0;
  /// The memory of a deformer in bytes, with the shape that it makes and its copy of the vertices.
  std::size_t type1_bytes = 0;
  std::size_t type2_bytes = 0;
};

/// Measures on the plane of Table 1 with this number of cells per side.
GrowthTimes measure_growth(int cells, int repetitions);

/// The times with many small supports, beside ten supports that reach every vertex.
struct CrowdTimes {
  std::size_t vertices = 0;
  std::size_t centres = 0;
  std::size_t influences = 0;
  double build_us = 0.0; ///< order, assembly, factor
  double solve_us = 0.0;
  double list_us = 0.0;     ///< which supports reach which blocks
  double evaluate_us = 0.0; ///< that, and the evaluation
  double ten_ns = 0.0;      ///< an influence's time, with the ten

  double ns_an_influence() const noexcept {
    return 1e3 * evaluate_us / static_cast<double>(influences);
  }
};

/// Measures with random centres over the plane, of which about `overlap` reach a vertex.
CrowdTimes measure_crowd(int cells, std::size_t centres, double overlap, int repetitions);

} // namespace nendo::bench
