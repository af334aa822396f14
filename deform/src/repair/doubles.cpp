#include "repair/steps.hpp"

#include <algorithm>
#include <numeric>

#include "repair/stitch.hpp"
#include "repair/weld.hpp"

namespace nendo::deform {
namespace {

using FacePlaces = std::vector<std::uint32_t>;

/// The places of a face from the least on, in the direction of the face.
FacePlaces turned_to_least(std::span<const std::uint32_t> own) {
  FacePlaces places(own.begin(), own.end());
  std::rotate(places.begin(), std::min_element(places.begin(), places.end()), places.end());
  return places;
}

/// The same for both directions.
FacePlaces whichever_way(const FacePlaces& places) {
  FacePlaces back(places.rbegin(), places.rend());
  return std::min(places, turned_to_least(back));
}

/// Of each face whether it is one of a wall: faces that are there more than once and hang together,
/// at whose rim two others meet everywhere. A wall has a body on each side.
std::vector<std::uint8_t> walls_of(const Mesh& mesh, const std::vector<std::uint32_t>& place_of,
                                   const std::vector<std::uint32_t>& first_of) {
  const std::vector<PlacedEdge> edges = placed_edges(mesh, place_of);
  const auto is_double = [&](const PlacedEdge& side) { return first_of[side.face] != no_index; };
  UnionFind together(first_of.size());
  for_each_edge(edges, [&](std::span<const PlacedEdge> sides) {
    const auto first = std::find_if(sides.begin(), sides.end(), is_double);
    for (auto other = first; other != sides.end(); ++other)
      if (is_double(*other)) together.join(first->face, other->face);
  });
  std::vector<std::uint8_t> has_rim(first_of.size(), 0), is_bad(first_of.size(), 0);
  for_each_edge(edges, [&](std::span<const PlacedEdge> sides) {
    const auto doubles = std::count_if(sides.begin(), sides.end(), is_double);
    if (doubles == 0) return;
    const std::uint32_t of =
        together.find(std::find_if(sides.begin(), sides.end(), is_double)->face);
    const auto others = static_cast<std::ptrdiff_t>(sides.size()) - doubles;
    if (others == 2) has_rim[of] = 1;
    if ((others == 0 && doubles == 2) || (others != 0 && others != 2)) is_bad[of] = 1;
  });
  std::vector<std::uint8_t> walls(first_of.size(), 0);
  for (std::uint32_t face = 0; face < walls.size(); ++face) {
    const std::uint32_t of = together.find(face);
    walls[face] = first_of[face] != no_index && has_rim[of] != 0 && is_bad[of] == 0 ? 1 : 0;
  }
  return walls;
}

} // namespace

std::size_t drop_double_faces(Mesh& mesh, std::vector<std::uint32_t>& place_of) {
  const auto own = [&](std::size_t face) {
    return std::span(place_of).subspan(mesh.face_starts[face],
                                       mesh.face_starts[face + 1] - mesh.face_starts[face]);
  };
  std::vector<FacePlaces> keys;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    keys.push_back(whichever_way(turned_to_least(own(face))));
  std::vector<std::uint32_t> order(keys.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  // Of each face that is there more than once, the first.
  std::vector<std::uint32_t> first_of(keys.size(), no_index);
  bool any = false;
  for (std::size_t at = 1; at < order.size(); ++at) {
    if (keys[order[at]] != keys[order[at - 1]]) continue;
    std::uint32_t& before = first_of[order[at - 1]];
    if (before == no_index) before = order[at - 1];
    first_of[order[at]] = before;
    any = true;
  }
  if (!any) return 0;
  const std::vector<std::uint8_t> walls = walls_of(mesh, place_of, first_of);
  std::vector<std::uint8_t> keeps(keys.size(), 1), opposite(keys.size(), 0);
  std::size_t dropped = 0;
  for (std::uint32_t face = 0; face < keys.size(); ++face) {
    const std::uint32_t first = first_of[face];
    if (first == no_index || first == face) continue;
    const bool back_to_back = turned_to_least(own(face)) != turned_to_least(own(first));
    const bool is_wall = back_to_back && opposite[first] == 0 && walls[face] != 0;
    if (is_wall) {
      opposite[first] = 1;
      continue;
    }
    keeps[face] = 0;
    ++dropped;
  }
  std::vector<std::uint32_t> places;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    if (keeps[face] != 0) places.insert(places.end(), own(face).begin(), own(face).end());
  keep_faces(mesh, keeps);
  place_of = std::move(places);
  return dropped;
}

} // namespace nendo::deform
