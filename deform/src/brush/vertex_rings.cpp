#include <nendo/deform/vertex_rings.hpp>

#include <algorithm>
#include <utility>

#include <nendo/deform/triangles.hpp>

#include "geometry/rows_by_key.hpp"

namespace nendo::deform {

VertexRings::VertexRings(const Mesh& mesh, const BlockLayout& layout) {
  find_rings(mesh, layout);
  const std::size_t rings = ring_.empty() ? 0 : 1 + *std::max_element(ring_.begin(), ring_.end());
  const std::vector<std::uint32_t> places = layout.places();
  auto rows = rows_by_key<std::array<std::uint32_t, 2>>(rings, [&](const auto& visit) {
    for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& vertices) {
      for (std::size_t at = 0; at < 3; ++at)
        visit(ring_[places[vertices[at]]],
              std::array{places[vertices[(at + 1) % 3]], places[vertices[(at + 2) % 3]]});
    });
  });
  triangle_starts_ = std::move(rows.starts);
  corners_ = std::move(rows.items);
  find_neighbours();
}

/// Numbers the different places of the model.
void VertexRings::find_rings(const Mesh& mesh, const BlockLayout& layout) {
  const std::vector<std::uint32_t>& order = layout.order();
  const auto at = [&](std::uint32_t place) {
    return mesh.vertices.col(static_cast<Eigen::Index>(order[place]));
  };
  const auto is_before = [&](std::uint32_t a, std::uint32_t b) {
    const auto first = at(a);
    const auto second = at(b);
    return std::lexicographical_compare(first.begin(), first.end(), second.begin(), second.end());
  };
  std::vector<std::uint32_t> sorted = all_indices(order.size());
  std::sort(sorted.begin(), sorted.end(), is_before);
  ring_.resize(order.size());
  std::uint32_t ring = 0;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    if (k > 0 && is_before(sorted[k - 1], sorted[k])) ++ring;
    ring_[sorted[k]] = ring;
  }
}

void VertexRings::find_neighbours() {
  const std::size_t rings = triangle_starts_.size() - 1;
  neighbour_starts_.assign(1, 0);
  std::vector<std::uint32_t> others; // each by one of the vertices of its ring
  const auto same_ring = [this](std::uint32_t a, std::uint32_t b) { return ring_[a] == ring_[b]; };
  const auto by_ring = [this](std::uint32_t a, std::uint32_t b) { return ring_[a] < ring_[b]; };
  for (std::size_t ring = 0; ring < rings; ++ring) {
    others.clear();
    for (std::size_t at = triangle_starts_[ring]; at < triangle_starts_[ring + 1]; ++at)
      others.insert(others.end(), corners_[at].begin(), corners_[at].end());
    std::sort(others.begin(), others.end(), by_ring);
    // An edge with a triangle on one side only is on the border.
    const auto take = [&](bool on_border) {
      for (auto from = others.begin(); from != others.end();) {
        const auto to = std::find_if_not(
            from, others.end(), [&](std::uint32_t other) { return same_ring(*from, other); });
        if (!on_border || to - from == 1) neighbours_.push_back(*from);
        from = to;
      }
    };
    take(true);
    if (neighbours_.size() == neighbour_starts_.back()) take(false);
    neighbour_starts_.push_back(static_cast<std::uint32_t>(neighbours_.size()));
  }
}

Eigen::Vector3d area_normal(const VertexRings& rings, const BlockShape& shape,
                            std::size_t place) noexcept {
  const Eigen::Vector3f here = vertex_at(shape, place);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& [a, b] : rings.triangles(place)) {
    const Eigen::Vector3d to_a = (vertex_at(shape, a) - here).cast<double>();
    const Eigen::Vector3d to_b = (vertex_at(shape, b) - here).cast<double>();
    sum += to_a.cross(to_b);
  }
  return sum;
}

} // namespace nendo::deform
