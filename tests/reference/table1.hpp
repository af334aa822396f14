#pragma once
// The planes and control points of the paper's Table 1: a plane in four resolutions and ten control
// points, whose places the paper does not give. Those of the layout `near` reproduce the paper's
// counts of vertices within the supports, except for a few. Those of `plane` lie in the plane
// itself, where a linear polynomial is not determined.

#include <array>
#include <random>

#include <nendo/deform/mesh.hpp>

namespace nendo::reference {

inline constexpr std::array<double, 5> table1_radii{10.0, 20.0, 40.0, 60.0, 80.0};

/// A plane of so many cells a side. With a vertex in each cell's middle, it has four triangles a
/// cell instead of two.
struct Table1Plane {
  int cells;
  bool with_middles;
};
inline constexpr std::array<Table1Plane, 4> table1_planes{
    {{32, false}, {64, false}, {128, false}, {128, true}}};

struct Table1Layout {
  const char* name;
  double height; ///< over the plane
};
inline constexpr std::array<Table1Layout, 2> table1_layouts{{{"near", 2.0}, {"plane", 0.0}}};

/// Returns the vertices of the plane, which is 50 by 50 in z = 0.
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

/// Returns the plane with its triangles, which face upwards.
deform::Mesh table1_mesh(const Table1Plane& plane);

inline deform::Points table1_starts(double height = table1_layouts[0].height) {
  deform::Points starts(3, 10);
  Eigen::Index at = 0;
  for (const double y : {15.0, 35.0})
    for (const double x : {-15.0, 5.0, 25.0, 45.0, 65.0})
      starts.col(at++) << x, y, height;
  return starts;
}

/// Returns how many pairs of a vertex and a control point are less than the radius apart. A frame
/// has to evaluate these. Looks at every pair.
std::size_t count_evaluations(const deform::Points& vertices, const deform::Points& starts,
                              double radius);

/// Returns the fingertips of two hands over the plane, 3 to 8 apart.
inline deform::Points crowded_starts() {
  deform::Points starts(3, 10);
  starts << 12, 14, 18, 22, 26, 38, 36, 32, 28, 27, //
      14, 20, 23, 23, 20, 34, 28, 25, 26, 33,       //
      2, 3, 2, 1, 2, 3, 1, 2, 3, 2;
  return starts;
}

/// Returns control points in the plane. Supports of radius 10 each reach a fifth of it at most.
inline deform::Points spread_starts() {
  deform::Points starts(3, 10);
  for (Eigen::Index i = 0; i < 10; ++i)
    starts.col(i) << 5.0 + 10.0 * static_cast<double>(i % 5), i < 5 ? 15.0 : 35.0, 2.0;
  return starts;
}

/// Returns random displacements of about 1.5 along the plane and 4 out of it.
inline deform::Points table1_displacements(std::mt19937& random) {
  std::normal_distribution<double> normal;
  deform::Points moves(3, 10);
  for (Eigen::Index i = 0; i < 10; ++i)
    moves.col(i) << 1.5 * normal(random), 1.5 * normal(random), 4.0 * normal(random);
  return moves;
}

} // namespace nendo::reference
