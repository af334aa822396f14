#pragma once
// Closed meshes that are thin somewhere.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "support/nasty_meshes.hpp"

namespace nendo::test {

/// A surface of revolution about y: `around` vertices at each of the radii, which are a step apart,
/// with a pole at each end.
inline deform::Mesh turned(const std::vector<double>& radii, double step, std::uint32_t around) {
  deform::Mesh mesh;
  const auto rows = static_cast<std::uint32_t>(radii.size());
  mesh.vertices.resize(3, rows * around + 2);
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t at = 0; at < around; ++at) {
      const double angle = 2.0 * std::numbers::pi * (at + 0.5 * (row % 2)) / around;
      mesh.vertices.col(row * around + at) << radii[row] * std::cos(angle), step * row,
          -radii[row] * std::sin(angle);
    }
  const std::uint32_t low = rows * around, high = low + 1;
  mesh.vertices.col(low) << 0.0, -0.5 * step, 0.0;
  mesh.vertices.col(high) << 0.0, step * (rows - 0.5), 0.0;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.face_corners.insert(mesh.face_corners.end(), {a, b, c});
    mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
  };
  for (std::uint32_t at = 0; at < around; ++at) {
    const std::uint32_t next = (at + 1) % around;
    add(low, next, at);
    for (std::uint32_t row = 0; row + 1 < rows; ++row) {
      const std::uint32_t a = row * around + at, b = row * around + next;
      const std::uint32_t c = a + around, d = b + around;
      if (row % 2 == 0) {
        add(a, b, c);
        add(b, d, c);
      } else {
        add(a, d, c);
        add(a, b, d);
      }
    }
    add(high, (rows - 1) * around + at, (rows - 1) * around + next);
  }
  return mesh;
}

/// Two cones with three edges around where they meet.
inline deform::Mesh hourglass(double neck) {
  std::vector<double> radii;
  for (int row = -8; row <= 8; ++row)
    radii.push_back(neck + 0.35 * std::abs(row));
  deform::Mesh mesh = turned(radii, 0.6, 3);
  mesh.detail.assign(static_cast<std::size_t>(mesh.vertices.cols()),
                     deform::VertexDetail{0.6F, false});
  return mesh;
}

/// A box of cells whose upper and lower side come near each other in the middle.
inline deform::Mesh dented_plate(double thickness, double left) {
  deform::Mesh plate = cube_of_cells(16);
  for (auto column : plate.vertices.colwise()) {
    column.y() = (column.y() - 0.5) * thickness;
    const double r = std::hypot(column.x() - 0.5, column.z() - 0.5);
    const double dent = std::max(0.0, 1.0 - r / 0.2);
    column.y() *= 1.0 - (1.0 - left / thickness) * dent;
  }
  return plate;
}

} // namespace nendo::test
