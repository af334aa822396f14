#pragma once
// Which vertices of faces are one, if faces that share an edge are joined there and nowhere else.

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "geometry/union_find.hpp"

namespace nendo::deform {

/// Returns of each point a number that points of one place share, the least of their own. 0 and -0
/// are one. Allocates.
std::vector<std::uint32_t> exact_places(const Points& points);

/// The edge after a corner, from the lesser place to the greater one. Broken models have edges with
/// any number of faces, which may face any way, so twins (HalfEdges, SurfaceMesh) cannot describe
/// them: all steps of repairing share this sorted table instead.
struct PlacedEdge {
  std::uint32_t low, high;
  std::uint32_t corner, next; ///< corners of its face
  std::uint32_t face;
  bool forward; ///< the face goes from the lesser place to the greater one

  auto operator<=>(const PlacedEdge&) const = default;

  std::uint32_t at_low() const noexcept { return forward ? corner : next; }
  std::uint32_t at_high() const noexcept { return forward ? next : corner; }
};

/// Returns the edges of all faces that have three places at least, by their places and then by
/// their corners. `place_of` has one entry for each corner. Allocates.
std::vector<PlacedEdge> placed_edges(const Mesh& mesh, std::span<const std::uint32_t> place_of);

/// Calls visit(std::span<const PlacedEdge>) for all sides of each edge.
template <class Visit>
void for_each_edge(const std::vector<PlacedEdge>& edges, const Visit& visit) {
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end].low == edges[begin].low &&
           edges[end].high == edges[begin].high)
      ++end;
    visit(std::span(edges).subspan(begin, end - begin));
    begin = end;
  }
}

/// Joins elements at the ends of edges that two faces share. `place_of` and `element_of` have one
/// entry for each corner of the mesh: an edge lies between two places, and elements are what is
/// joined. Where more than two faces meet at an edge, faces that are joined already belong
/// together, and then those with the inside of the model between them, by the angles about the
/// edge; what is left stays apart. So do two faces back to back. Faces with fewer than three places
/// are left out. Allocates; the same sets for the same arguments.
void stitch(const Mesh& mesh, std::span<const std::uint32_t> place_of,
            std::span<const std::uint32_t> element_of, UnionFind& sets);

} // namespace nendo::deform
