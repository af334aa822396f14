#pragma once
// The triangles and the neighbours around each vertex: its one-ring.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// Vertices are indexed in block order (BlockLayout::order()). Vertices at the same position in the
/// model, such as along texture seams, share one ring, so that results from rings move them
/// equally. Immutable: thread-safe.
class NENDO_API VertexRings {
public:
  /// The layout must be the mesh's. Allocates.
  VertexRings(const Mesh& mesh, const BlockLayout& layout);

  std::size_t vertex_count() const noexcept { return ring_.size(); }
  /// Returns the other two corners of each triangle around the vertex, so that the triangle's
  /// corners are counter-clockwise from outside.
  std::span<const std::array<std::uint32_t, 2>> triangles(std::size_t place) const noexcept {
    const std::size_t ring = ring_[place];
    return {corners_.data() + triangle_starts_[ring],
            triangle_starts_[ring + 1] - triangle_starts_[ring]};
  }
  /// Returns the neighbours of the vertex; for a vertex on the surface's border, only those along
  /// the border, so that a border is smoothed as a line.
  std::span<const std::uint32_t> neighbours(std::size_t place) const noexcept {
    const std::size_t ring = ring_[place];
    return {neighbours_.data() + neighbour_starts_[ring],
            neighbour_starts_[ring + 1] - neighbour_starts_[ring]};
  }

private:
  void find_rings(const Mesh& mesh, const BlockLayout& layout);
  void find_neighbours();

  std::vector<std::uint32_t> ring_; ///< the ring of each vertex
  std::vector<std::uint32_t> triangle_starts_, neighbour_starts_;
  std::vector<std::array<std::uint32_t, 2>> corners_;
  std::vector<std::uint32_t> neighbours_;
};

/// Returns six times the derivative of the enclosed volume with respect to the vertex's position,
/// in the units of the shape: the sum of the cross products of its triangles. It points outwards,
/// and its length is twice the area of the triangles where they are flat.
NENDO_API Eigen::Vector3d area_normal(const VertexRings& rings, const BlockShape& shape,
                                      std::size_t place) noexcept;

} // namespace nendo::deform
