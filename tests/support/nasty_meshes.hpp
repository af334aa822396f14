#pragma once
// Closed models that make cuts difficult: holes, thin walls, coplanar faces, and vertices that lie
// in rows.

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "support/test_meshes.hpp"

namespace nendo::test {

inline deform::Mesh torus(std::uint32_t around, std::uint32_t across) {
  deform::Mesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(around) * across);
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double turn = 2.0 * std::numbers::pi * i / around;
      const double roll = 2.0 * std::numbers::pi * j / across;
      const double radius = 1.0 + 0.35 * std::cos(roll);
      mesh.vertices.col(i * across + j) << radius * std::cos(turn), radius * std::sin(turn),
          0.35 * std::sin(roll);
    }
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const std::uint32_t next_i = (i + 1) % around * across, next_j = (j + 1) % across;
      const std::uint32_t a = i * across + j, b = next_i + j, c = next_i + next_j,
                          d = i * across + next_j;
      add_face(mesh, {a, b, c});
      add_face(mesh, {a, c, d});
    }
  return mesh;
}

/// Returns a ball of triangles whose inside is hollow up to `hollow` of the radius.
inline deform::Mesh shell(std::uint32_t rings, double hollow) {
  const deform::Mesh ball = sphere(rings, 2 * rings, 1.0);
  deform::Mesh mesh;
  const auto count = static_cast<std::uint32_t>(ball.vertices.cols());
  mesh.vertices.resize(3, 2 * static_cast<Eigen::Index>(count));
  mesh.vertices.leftCols(count) = ball.vertices;
  mesh.vertices.rightCols(count) = hollow * ball.vertices;
  for (std::size_t face = 0; face < ball.face_count(); ++face)
    for (std::uint32_t at = ball.face_starts[face] + 2; at < ball.face_starts[face + 1]; ++at) {
      const std::uint32_t a = ball.face_corners[ball.face_starts[face]];
      const std::uint32_t b = ball.face_corners[at - 1], c = ball.face_corners[at];
      add_face(mesh, {a, b, c});
      add_face(mesh, {count + a, count + c, count + b});
    }
  return mesh;
}

/// Returns the skin of those cells of a cube of n^3 that `is_in(x, y, z)` chooses. Cells must touch
/// by faces only. With `quads` it has squares, else triangles.
template <class IsIn>
deform::Mesh cells(int n, const IsIn& is_in, bool quads = false) {
  std::map<std::array<int, 3>, std::uint32_t> numbers;
  std::vector<std::array<int, 3>> places;
  deform::Mesh mesh;
  const auto is_solid = [&](const std::array<int, 3>& cell) {
    for (const int k : cell)
      if (k < 0 || k >= n) return false;
    return is_in(cell[0], cell[1], cell[2]);
  };
  const auto add_side = [&](const std::array<int, 3>& cell, std::size_t axis, int side) {
    std::array<std::uint32_t, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<int, 3> place = cell;
      place[axis] += side;
      place[(axis + 1) % 3] += k == 1 || k == 2 ? 1 : 0;
      place[(axis + 2) % 3] += k >= 2 ? 1 : 0;
      const auto [found, is_new] =
          numbers.try_emplace(place, static_cast<std::uint32_t>(places.size()));
      if (is_new) places.push_back(place);
      corners[k] = found->second;
    }
    if (side == 0) std::swap(corners[1], corners[3]);
    if (quads) {
      add_face(mesh, {corners[0], corners[1], corners[2], corners[3]});
      return;
    }
    add_face(mesh, {corners[0], corners[1], corners[2]});
    add_face(mesh, {corners[0], corners[2], corners[3]});
  };
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z)
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> beyond{x, y, z};
            beyond[axis] += side == 0 ? -1 : 1;
            if (is_solid({x, y, z}) && !is_solid(beyond)) add_side({x, y, z}, axis, side);
          }
  mesh.vertices.resize(3, static_cast<Eigen::Index>(places.size()));
  for (std::size_t at = 0; at < places.size(); ++at)
    for (std::size_t k = 0; k < 3; ++k)
      mesh.vertices(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(at)) =
          static_cast<double>(places[at][k]) / n;
  return mesh;
}

inline deform::Mesh cube_of_cells(int n, bool quads = false) {
  return cells(n, [](int, int, int) { return true; }, quads);
}

/// n must be odd, so that a tooth stands at both ends.
inline deform::Mesh comb(int n) {
  return cells(n, [](int x, int y, int) { return y < 4 || x % 2 == 0; });
}

/// Menger's sponge.
inline deform::Mesh sponge(int level) {
  int n = 1;
  for (int k = 0; k < level; ++k)
    n *= 3;
  return cells(n, [level](int x, int y, int z) {
    for (int k = 0; k < level; ++k, x /= 3, y /= 3, z /= 3)
      if ((x % 3 == 1) + (y % 3 == 1) + (z % 3 == 1) >= 2) return false;
    return true;
  });
}

} // namespace nendo::test
