#pragma once
// Distances along a surface. Through the air the lips of a closed mouth are a millimetre apart;
// along the skin they are centimetres apart, so that a mouth whose parts are distinguished by the
// distance along its skin can open.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// A place on a surface: the corners of a triangle of it, and their barycentric weights, whose sum
/// is 1. It goes where the surface goes.
struct NENDO_API SurfacePlace {
  std::array<std::uint32_t, 3> corners{};
  std::array<double, 3> weights{1.0, 0.0, 0.0};

  static SurfacePlace at_vertex(std::uint32_t vertex) noexcept {
    return {{vertex, vertex, vertex}};
  }
  /// Returns where it is; vertices: 3 by #vertices.
  Eigen::Vector3d in(const Points& vertices) const;
};

/// Returns the place of the mesh's faces that is nearest to `to`, in model units. The mesh must
/// have a face.
/// With `parts` (SurfaceGraph::parts()), only of that part, which must have a face.
NENDO_API SurfacePlace nearest_place(const Mesh& mesh, const Eigen::Vector3d& to,
                                     std::span<const std::uint32_t> parts = {},
                                     std::uint32_t part = 0);

/// The ways along a surface: its edges, the diagonals of its faces, and the straight lines across
/// an edge between two triangles. The shortest of them (Dijkstra 1959) are longer than true
/// geodesics by some per cent, which does not show where a radius spans ten edges.
class NENDO_API SurfaceGraph {
public:
  /// `mesh` must outlive the graph. Allocates.
  explicit SurfaceGraph(const Mesh& mesh);

  std::size_t vertex_count() const noexcept { return starts_.size() - 1; }
  /// Returns the distance of each vertex from that place, in model units; infinity if it is more
  /// than `limit`, or if no way leads there. Allocates.
  Eigen::VectorXd distances(const SurfacePlace& from, double limit) const;
  /// Returns for each vertex the number of the part of the surface to which it belongs, counted
  /// from 0 by their first vertices. No way leads from one part to another.
  std::vector<std::uint32_t> parts() const;

private:
  struct Way {
    std::uint32_t to;
    double length;
  };
  /// The vertices that a straight way leads to: those of the place's face or edge, and those that
  /// are neighbours of all of these. On an edge, that is both sides of it, so that places which are
  /// mirror images have ways that are.
  std::vector<std::uint32_t> about(const SurfacePlace& place) const;

  const Points& vertices_;
  std::vector<std::size_t> starts_; ///< the first way of each vertex
  std::vector<Way> ways_;
};

} // namespace nendo::deform
