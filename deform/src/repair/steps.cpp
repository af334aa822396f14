// Splits edges at vertices that lie on them, and drops double faces.

#include "repair/steps.hpp"

#include <algorithm>
#include <compare>
#include <map>

#include "mesh/columns.hpp"
#include "repair/stitch.hpp"
#include "repair/weld.hpp"

namespace nendo::deform {
namespace {

/// A vertex in an edge: how far along from the edge's corner, and where.
struct JunctionPoint {
  double along;
  std::uint32_t place;
  auto operator<=>(const JunctionPoint&) const = default;
};

/// By the corner after which they come.
using Junctions = std::map<std::uint32_t, std::vector<JunctionPoint>>;

/// Nothing if there are too many open edges to be compared with all that may lie in them.
std::optional<Junctions> junctions_of(const Mesh& mesh, const std::vector<std::uint32_t>& place_of,
                                      double tolerance) {
  constexpr std::size_t max_looks = 100'000'000;
  std::vector<PlacedEdge> open;
  for_each_edge(placed_edges(mesh, place_of), [&](std::span<const PlacedEdge> sides) {
    if (sides.size() == 1) open.push_back(sides[0]);
  });
  std::vector<std::pair<double, std::uint32_t>> by_x; // open places
  for (const PlacedEdge& edge : open)
    for (const std::uint32_t place : {edge.low, edge.high})
      by_x.emplace_back(space_point(mesh.vertices, place)[0], place);
  std::sort(by_x.begin(), by_x.end());
  by_x.erase(std::unique(by_x.begin(), by_x.end()), by_x.end());
  Junctions found;
  std::size_t looks = 0;
  for (const PlacedEdge& edge : open) {
    const std::uint32_t from = place_of[edge.corner], to = place_of[edge.next];
    const SpacePoint begin = space_point(mesh.vertices, from);
    const SpacePoint way = space_point(mesh.vertices, to) - begin;
    const double length = length_of(way);
    if (!(length > 2.0 * tolerance)) continue;
    const double low = std::min(begin[0], begin[0] + way[0]) - tolerance;
    const double high = std::max(begin[0], begin[0] + way[0]) + tolerance;
    for (auto at = std::lower_bound(by_x.begin(), by_x.end(), std::pair(low, std::uint32_t{0}));
         at != by_x.end() && at->first <= high; ++at) {
      if (++looks > max_looks) return std::nullopt;
      if (at->second == from || at->second == to) continue;
      const SpacePoint beside = space_point(mesh.vertices, at->second) - begin;
      const double along = dot(beside, way) / (length * length);
      if (along * length <= tolerance || (1.0 - along) * length <= tolerance) continue;
      if (length_of(beside - along * way) > tolerance) continue;
      found[edge.corner].push_back({along, at->second});
    }
  }
  for (auto& [corner, points] : found)
    std::sort(points.begin(), points.end());
  return found;
}

/// Texture coordinates between others, and the colours of these places, in new last columns.
class MixedTexcoords {
public:
  explicit MixedTexcoords(Mesh& mesh) : mesh_(mesh), before_(mesh.texcoords.cols()) {}
  std::uint32_t between(std::uint32_t a, std::uint32_t b, double along) {
    if (a == b) return a;
    more_.push_back({a, b, along});
    return static_cast<std::uint32_t>(before_) + to_index(more_.size()) - 1;
  }
  void finish() {
    append_to(mesh_.texcoords);
    if (mesh_.look.texcoord_colours.cols() > 0) append_to(mesh_.look.texcoord_colours);
  }

private:
  struct Mix {
    std::uint32_t a, b;
    double along;
  };
  template <class Columns>
  void append_to(Columns& columns) {
    columns.conservativeResize(columns.rows(), before_ + static_cast<Eigen::Index>(more_.size()));
    for (std::size_t at = 0; at < more_.size(); ++at) {
      const auto along = static_cast<typename Columns::Scalar>(more_[at].along);
      columns.col(before_ + static_cast<Eigen::Index>(at)) =
          (1 - along) * columns.col(more_[at].a) + along * columns.col(more_[at].b);
    }
  }

  Mesh& mesh_;
  Eigen::Index before_;
  std::vector<Mix> more_;
};

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

SplitJunctions split_at_junctions(Mesh& mesh, std::vector<std::uint32_t>& place_of,
                                  double tolerance) {
  const auto found = junctions_of(mesh, place_of, tolerance);
  if (!found) return {.count = 0, .is_too_many = true};
  const Junctions& junctions = *found;
  if (junctions.empty()) return {};
  const Mesh before = mesh;
  const std::vector<std::uint32_t> places = std::move(place_of);
  place_of.clear();
  mesh.face_corners.clear();
  mesh.corner_texcoords.clear();
  MixedTexcoords texcoords(mesh);
  std::size_t added = 0;
  const auto put = [&](std::uint32_t vertex, std::uint32_t place) {
    mesh.face_corners.push_back(vertex);
    place_of.push_back(place);
  };
  for (std::size_t face = 0; face < before.face_count(); ++face) {
    const std::uint32_t begin = before.face_starts[face], end = before.face_starts[face + 1];
    for (std::uint32_t at = begin; at < end; ++at) {
      const std::uint32_t next = at + 1 < end ? at + 1 : begin;
      put(before.face_corners[at], places[at]);
      if (!before.corner_texcoords.empty())
        mesh.corner_texcoords.push_back(before.corner_texcoords[at]);
      const auto here = junctions.find(at);
      if (here == junctions.end()) continue;
      for (const JunctionPoint& point : here->second) {
        put(point.place, point.place);
        ++added;
        if (before.corner_texcoords.empty()) continue;
        mesh.corner_texcoords.push_back(texcoords.between(
            before.corner_texcoords[at], before.corner_texcoords[next], point.along));
      }
    }
    mesh.face_starts[face + 1] = to_index(mesh.face_corners.size());
  }
  texcoords.finish();
  return {.count = added};
}

std::size_t drop_double_faces(Mesh& mesh, std::vector<std::uint32_t>& place_of) {
  const auto own = [&](std::size_t face) {
    return std::span(place_of).subspan(mesh.face_starts[face], mesh.corners_of(face).size());
  };
  std::vector<FacePlaces> keys;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    keys.push_back(whichever_way(turned_to_least(own(face))));
  const auto key = [&](std::uint32_t face) -> const FacePlaces& { return keys[face]; };
  const std::vector<std::uint32_t> alike = first_alike(keys.size(), key);
  // Of each face that is there more than once, the first.
  std::vector<std::uint32_t> first_of(keys.size(), no_index);
  bool any = false;
  for (std::uint32_t face = 0; face < keys.size(); ++face) {
    if (alike[face] == face) continue;
    first_of[face] = first_of[alike[face]] = alike[face];
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
  keep_faces(mesh, keeps, place_of);
  return dropped;
}

} // namespace nendo::deform
