#pragma once
// Triangles in the form that the half edges and the check of polygons want.

#include <cstdint>
#include <span>
#include <vector>

#include "join/space.hpp"
#include "mesh/half_edges.hpp"

namespace nendo::deform {

/// Polygons' lists of triangles: corners one after another, and where each face starts.
struct TriangleList {
  std::vector<std::uint32_t> starts, corners;

  explicit TriangleList(std::span<const Corners> faces) {
    starts.reserve(faces.size() + 1);
    corners.reserve(3 * faces.size());
    starts.push_back(0);
    for (const Corners& face : faces) {
      corners.insert(corners.end(), face.begin(), face.end());
      starts.push_back(static_cast<std::uint32_t>(corners.size()));
    }
  }
  HalfEdges half_edges(std::size_t points) const { return half_edges_of(starts, corners, points); }
};

} // namespace nendo::deform
