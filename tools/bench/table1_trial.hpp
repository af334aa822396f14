#pragma once
// Measures one cell of the paper's Table 1: both types with one thread and two, both by the plain
// loop, and both in a whole frame as the paper timed it.

#include <array>
#include <cstddef>

#include <nendo/deform/mesh.hpp>

namespace nendo::bench {

/// Frames per second, the best of many. A frame takes new displacements, solves, and moves all
/// vertices; one of Type-2 also assembles and factorises. Nothing is drawn but in whole frames.
struct Table1Cell {
  using Types = std::array<double, 2>; ///< Type-1, Type-2

  std::size_t evaluations = 0; ///< a frame, counted
  Types one_thread{};
  Types two_threads{};
  Types plain_loop{};  ///< 0 if the processor has no AVX2
  Types whole_frame{}; ///< one thread; p(x), normals and drawing included (whole_frame.hpp)
};

/// Measures for about this number of seconds, but with at least one repetition of each measurement.
Table1Cell measure_table1_cell(const deform::Mesh& plane, const deform::Points& starts,
                               double radius, double seconds);

} // namespace nendo::bench
