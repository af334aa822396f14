#include "mesh/half_edges.hpp"

namespace nendo::deform {

/// Each edge that goes from a lesser to a greater vertex looks for those that come back.
std::vector<std::uint32_t> twins_of(std::span<const std::uint32_t> from,
                                    std::span<const std::uint32_t> to,
                                    const RowsByKey<std::uint32_t>& out) {
  constexpr std::uint32_t several = no_index - 1;
  std::vector<std::uint32_t> twins(from.size(), no_index);
  for (std::uint32_t edge = 0; edge < from.size(); ++edge) {
    if (from[edge] > to[edge]) continue;
    for (const std::uint32_t other : out[to[edge]]) {
      if (to[other] != from[edge]) continue;
      const bool is_only = twins[edge] == no_index && twins[other] == no_index;
      for (const std::uint32_t one : {edge, other}) {
        if (is_only) continue;
        // Neither these nor those that were taken for their twins have only one.
        if (twins[one] < several) twins[twins[one]] = several;
        twins[one] = several;
      }
      if (is_only) {
        twins[edge] = other;
        twins[other] = edge;
      }
    }
  }
  for (std::uint32_t& twin : twins)
    if (twin == several) twin = no_index;
  return twins;
}

HalfEdges half_edges_of(std::span<const std::uint32_t> face_starts,
                        std::span<const std::uint32_t> face_corners, std::size_t vertices) {
  HalfEdges edges;
  const std::size_t count = face_corners.size();
  edges.next.resize(count);
  edges.last.resize(count);
  std::vector<std::uint32_t> to(count);
  for (std::size_t face = 0; face + 1 < face_starts.size(); ++face) {
    const std::uint32_t begin = face_starts[face];
    const std::uint32_t end = face_starts[face + 1];
    for (std::uint32_t edge = begin; edge < end; ++edge) {
      edges.next[edge] = edge + 1 < end ? edge + 1 : begin;
      edges.last[edge] = edge > begin ? edge - 1 : end - 1;
      to[edge] = face_corners[edges.next[edge]];
    }
  }
  edges.out = rows_by_key<std::uint32_t>(vertices, [&](const auto& visit) {
    for (std::uint32_t edge = 0; edge < count; ++edge)
      visit(face_corners[edge], edge);
  });
  edges.twin = twins_of(face_corners, to, edges.out);
  return edges;
}

} // namespace nendo::deform
