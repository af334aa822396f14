#include "mesh/half_edges.hpp"

namespace nendo::deform {
namespace {

/// Each edge that goes from a lesser to a greater vertex looks for those that come back.
void pair_edges(std::span<const std::uint32_t> face_corners, HalfEdges& edges) {
  constexpr std::uint32_t several = no_index - 1;
  for (std::uint32_t edge = 0; edge < face_corners.size(); ++edge) {
    const std::uint32_t from = face_corners[edge];
    const std::uint32_t to = face_corners[edges.next[edge]];
    if (from > to) continue;
    for (std::uint32_t at = edges.out_starts[to]; at < edges.out_starts[to + 1]; ++at) {
      const std::uint32_t other = edges.out[at];
      if (face_corners[edges.next[other]] != from) continue;
      const bool is_only = edges.twin[edge] == no_index && edges.twin[other] == no_index;
      for (const std::uint32_t one : {edge, other}) {
        if (is_only) continue;
        // Neither these nor those that were taken for their twins have only one.
        if (edges.twin[one] < several) edges.twin[edges.twin[one]] = several;
        edges.twin[one] = several;
      }
      if (is_only) {
        edges.twin[edge] = other;
        edges.twin[other] = edge;
      }
    }
  }
  for (std::uint32_t& twin : edges.twin)
    if (twin == several) twin = no_index;
}

} // namespace

HalfEdges half_edges_of(std::span<const std::uint32_t> face_starts,
                        std::span<const std::uint32_t> face_corners, std::size_t vertices) {
  HalfEdges edges;
  const std::size_t count = face_corners.size();
  edges.next.resize(count);
  edges.last.resize(count);
  edges.twin.assign(count, no_index);
  edges.out_starts.assign(vertices + 1, 0);
  edges.out.resize(count);
  for (const std::uint32_t corner : face_corners)
    ++edges.out_starts[corner + 1];
  for (std::size_t vertex = 0; vertex < vertices; ++vertex)
    edges.out_starts[vertex + 1] += edges.out_starts[vertex];
  std::vector<std::uint32_t> filled(edges.out_starts.begin(), edges.out_starts.end() - 1);
  for (std::size_t face = 0; face + 1 < face_starts.size(); ++face) {
    const std::uint32_t begin = face_starts[face];
    const std::uint32_t end = face_starts[face + 1];
    for (std::uint32_t edge = begin; edge < end; ++edge) {
      edges.next[edge] = edge + 1 < end ? edge + 1 : begin;
      edges.last[edge] = edge > begin ? edge - 1 : end - 1;
      edges.out[filled[face_corners[edge]]++] = edge;
    }
  }
  pair_edges(face_corners, edges);
  return edges;
}

} // namespace nendo::deform
