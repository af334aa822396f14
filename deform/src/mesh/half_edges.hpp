#pragma once
// Which edges of faces lie opposite to each other. Corner k of a face stands for the edge from this
// corner to the next one, so an edge has the number of its corner. The faces may be any polygons,
// and do not change. SurfaceMesh (surface_mesh.hpp) has triangles that do, and finds its twins by
// twins_of(). It cannot replace HalfEdges: the diagonals of triangles would be edges that the model
// does not have, and its checks name edges of the model.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/index.hpp>

#include "geometry/rows_by_key.hpp"

namespace nendo::deform {

struct HalfEdges {
  std::vector<std::uint32_t> next; ///< the edge behind it in its face
  std::vector<std::uint32_t> last; ///< the edge before it
  /// The edge of another face that goes the other way; no_index if there is none, or several.
  std::vector<std::uint32_t> twin;
  RowsByKey<std::uint32_t> out; ///< the edges that begin at each vertex, in rising order
};

/// Returns a key for maps: the edge from one vertex to another.
inline std::uint64_t edge_key(std::uint32_t from, std::uint32_t to) noexcept {
  return std::uint64_t{from} << 32 | to;
}

/// Each corner must be below `vertices`. Allocates.
HalfEdges half_edges_of(std::span<const std::uint32_t> face_starts,
                        std::span<const std::uint32_t> face_corners, std::size_t vertices);

/// Returns HalfEdges::twin of edges whose ends are `from` and `to`. Allocates.
std::vector<std::uint32_t> twins_of(std::span<const std::uint32_t> from,
                                    std::span<const std::uint32_t> to,
                                    const RowsByKey<std::uint32_t>& out);

/// As the public function, if the edges are at hand.
ManifoldCheck check_closed_manifold(std::span<const std::uint32_t> face_starts,
                                    std::span<const std::uint32_t> face_corners,
                                    const HalfEdges& edges);

} // namespace nendo::deform
