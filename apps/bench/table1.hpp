#pragma once
// The plane of the paper's Table 1 with its ten control points: a layout that gives the paper's
// counts of vertices within the supports, but for a few, and a crowded one, as ten fingertips are.

#include <array>
#include <random>

#include <nendo/deform/mesh.hpp>

namespace nendo::app {

inline constexpr std::array<double, 5> table1_radii{10.0, 20.0, 40.0, 60.0, 80.0};

/// 50 by 50. The paper's meshes have 32, 64 and 128 cells a side, and 128 with a vertex in each
/// cell's middle.
inline deform::Points table1_plane(int cells, bool with_middles = false) {
  const int side = cells + 1;
  deform::Points plane(3, side * side + (with_middles ? cells * cells : 0));
  Eigen::Index at = 0;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      plane.col(at++) << 50.0 * column / cells, 50.0 * row / cells, 0.0;
  if (!with_middles) return plane;
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column)
      plane.col(at++) << 50.0 * (column + 0.5) / cells, 50.0 * (row + 0.5) / cells, 0.0;
  return plane;
}

inline deform::Points table1_starts() {
  deform::Points starts(3, 10);
  Eigen::Index at = 0;
  for (const double y : {15.0, 35.0})
    for (const double x : {-15.0, 5.0, 25.0, 45.0, 65.0})
      starts.col(at++) << x, y, 2.0;
  return starts;
}

/// Two hands over the plane, fingertips 3 to 8 apart.
inline deform::Points crowded_starts() {
  deform::Points starts(3, 10);
  starts << 12, 14, 18, 22, 26, 38, 36, 32, 28, 27, //
      14, 20, 23, 23, 20, 34, 28, 25, 26, 33,       //
      2, 3, 2, 1, 2, 3, 1, 2, 3, 2;
  return starts;
}

/// About 1.5 across the plane and 4 out of it.
inline deform::Points table1_displacements(std::mt19937& random) {
  std::normal_distribution<double> normal;
  deform::Points moves(3, 10);
  for (Eigen::Index i = 0; i < 10; ++i)
    moves.col(i) << 1.5 * normal(random), 1.5 * normal(random), 4.0 * normal(random);
  return moves;
}

} // namespace nendo::app
