#pragma once
// Distances along a surface. The lips of a closed mouth are a millimetre apart in space, but
// centimetres apart along the skin, so with distances along the skin they move independently and
// the mouth can open.

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// A position on a surface: the corners of a triangle, and their barycentric weights, whose sum is
/// 1. It moves with the surface.
struct NENDO_API SurfacePosition {
  std::array<std::uint32_t, 3> corners{};
  std::array<double, 3> weights{1.0, 0.0, 0.0};

  static SurfacePosition at_vertex(std::uint32_t vertex) noexcept {
    return {{vertex, vertex, vertex}};
  }
  /// Returns its coordinates; vertices: 3 by #vertices.
  Eigen::Vector3d in(const Points& vertices) const;
};

/// Returns the position on the mesh's faces that is nearest to `to`, in model units. The mesh must
/// have a face. With `parts` (SurfaceGraph::parts()), searches only `part`, which must have a face.
NENDO_API SurfacePosition nearest_position(const Mesh& mesh, const Eigen::Vector3d& to,
                                           std::span<const std::uint32_t> parts = {},
                                           std::uint32_t part = 0);

/// The graph of paths along a surface: its edges, the diagonals of its faces, and the straight
/// lines across an edge between two triangles. Shortest paths (Dijkstra 1959) are a few per cent
/// longer than geodesics, which is not visible if a radius spans ten edges.
class NENDO_API SurfaceGraph {
public:
  /// `mesh` must outlive the graph. Allocates.
  explicit SurfaceGraph(const Mesh& mesh);

  std::size_t vertex_count() const noexcept { return starts_.size() - 1; }
  /// Returns the distance of each vertex from `from`, in model units; infinity if it exceeds
  /// `limit`, or if there is no path. Allocates.
  Eigen::VectorXd distances(const SurfacePosition& from, double limit) const;
  /// Returns the part index of each vertex. Parts are the connected components of the graph,
  /// indexed from 0 by first vertex.
  std::vector<std::uint32_t> parts() const;

private:
  struct Way {
    std::uint32_t to;
    double length;
    auto operator<=>(const Way&) const = default;
  };
  /// Returns the vertices that a straight line reaches: those of the position's face or edge, and
  /// their common neighbours. On an edge, these are on both sides, so that mirrored positions have
  /// mirrored paths.
  std::vector<std::uint32_t> about(const SurfacePosition& place) const;

  const Points& vertices_;
  std::vector<std::size_t> starts_; ///< index of each vertex's first entry in ways_
  std::vector<Way> ways_;
};

} // namespace nendo::deform
