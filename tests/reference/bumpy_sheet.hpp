#pragma once
// Points like control points on a surface: many, and in no order.

#include <cmath>
#include <random>

#include <nendo/deform/mesh.hpp>

namespace nendo::reference {

/// Returns `count` points over a square of side 1.
inline deform::Points bumpy_sheet(std::mt19937& random, Eigen::Index count) {
  std::uniform_real_distribution<double> place(0.0, 1.0);
  deform::Points points(3, count);
  for (auto point : points.colwise()) {
    const double x = place(random);
    const double y = place(random);
    point << x, y, 0.05 * std::sin(7.0 * x) * std::cos(5.0 * y);
  }
  return points;
}

} // namespace nendo::reference
