#pragma once
// Closed models for cutting and joining: from smooth to nasty.

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <utility>

#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>

#include "support/test_meshes.hpp"

namespace nendo::test {

/// A torus about the z axis with radii 1 and 0.4.
inline deform::Mesh torus(std::uint32_t around, std::uint32_t across) {
  deform::Mesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(around) * across);
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double turn = 2.0 * std::numbers::pi * i / around;
      const double tilt = 2.0 * std::numbers::pi * j / across;
      const double radius = 1.0 + 0.4 * std::cos(tilt);
      mesh.vertices.col(i * across + j) << radius * std::cos(turn), radius * std::sin(turn),
          0.4 * std::sin(tilt);
    }
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const std::uint32_t a = i * across + j;
      const std::uint32_t b = (i + 1) % around * across + j;
      const std::uint32_t c = (i + 1) % around * across + (j + 1) % across;
      const std::uint32_t d = i * across + (j + 1) % across;
      add_face(mesh, {a, b, c});
      add_face(mesh, {a, c, d});
    }
  return mesh;
}

/// The surface of those of n^3 cells of edge 1 for which solid(x, y, z) is true: many coplanar
/// faces. No two solid cells may share an edge or a corner alone.
template <class Solid>
deform::Mesh cells(int n, const Solid& solid) {
  std::map<std::array<int, 3>, std::uint32_t> numbers;
  deform::Mesh mesh;
  const auto is_solid = [&](const std::array<int, 3>& cell) {
    for (const int at : cell)
      if (at < 0 || at >= n) return false;
    return static_cast<bool>(solid(cell[0], cell[1], cell[2]));
  };
  const auto add_side = [&](const std::array<int, 3>& cell, std::size_t axis, int side) {
    std::array<std::uint32_t, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<int, 3> at = cell;
      at[axis] += side;
      if (k == 1 || k == 2) ++at[(axis + 1) % 3];
      if (k >= 2) ++at[(axis + 2) % 3];
      corners[k] =
          numbers.try_emplace(at, static_cast<std::uint32_t>(numbers.size())).first->second;
    }
    if (side == 0) std::swap(corners[1], corners[3]);
    add_face(mesh, {corners[0], corners[1], corners[2]});
    add_face(mesh, {corners[0], corners[2], corners[3]});
  };
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z)
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const int side : {0, 1}) {
            const std::array<int, 3> cell{x, y, z};
            std::array<int, 3> beyond = cell;
            beyond[axis] += side == 1 ? 1 : -1;
            if (is_solid(cell) && !is_solid(beyond)) add_side(cell, axis, side);
          }
  mesh.vertices.resize(3, static_cast<Eigen::Index>(numbers.size()));
  for (const auto& [place, number] : numbers)
    mesh.vertices.col(number) << place[0], place[1], place[2];
  return mesh;
}

inline deform::Mesh cube(int n) {
  return cells(n, [](int, int, int) { return true; });
}
/// A back of four cells with teeth on it, one cell thick and one apart.
inline deform::Mesh comb(int n) {
  return cells(n, [](int x, int y, int) { return y < 4 || x % 2 == 0; });
}

/// Moves the middle of its box to the origin and makes the box's diagonal 2.
inline deform::Mesh normalised(deform::Mesh mesh) {
  const deform::Box box = deform::finite_box_of(mesh.vertices);
  const Eigen::Vector3d middle = 0.5 * (box.lowest + box.highest);
  mesh.vertices = (mesh.vertices.colwise() - middle) * (2.0 / (box.highest - box.lowest).norm());
  return mesh;
}

inline deform::Mesh turned(deform::Mesh mesh, std::mt19937& random) {
  std::normal_distribution<double> number;
  const double w = number(random);
  const double x = number(random);
  const double y = number(random);
  const Eigen::Quaterniond turn(w, x, y, number(random));
  mesh.vertices = (turn.normalized().toRotationMatrix() * mesh.vertices).eval();
  return mesh;
}

inline deform::Mesh moved(deform::Mesh mesh, const Eigen::Vector3d& way) {
  mesh.vertices.colwise() += way;
  return mesh;
}

/// The volume that a closed mesh encloses, by the divergence theorem about its middle.
inline double volume_of(const deform::Mesh& mesh) {
  if (mesh.vertices.cols() == 0) return 0.0;
  const Eigen::Vector3d middle = mesh.vertices.rowwise().mean();
  double six_times = 0.0;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (std::uint32_t at = mesh.face_starts[face] + 2; at < mesh.face_starts[face + 1]; ++at) {
      const auto corner = [&](std::uint32_t number) -> Eigen::Vector3d {
        return mesh.vertices.col(mesh.face_corners[number]) - middle;
      };
      six_times += corner(mesh.face_starts[face]).dot(corner(at - 1).cross(corner(at)));
    }
  return six_times / 6.0;
}

} // namespace nendo::test
