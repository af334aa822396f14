#include "repair/turning.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <nendo/deform/triangles.hpp>

#include "cut/cut_assembly.hpp"
#include "join/crossings.hpp"
#include "repair/stitch.hpp"

namespace nendo::deform {
namespace {

template <class Values>
void reverse_behind_first(Values& values, std::uint32_t begin, std::uint32_t end) {
  if (values.empty() || end - begin < 2) return;
  std::reverse(values.begin() + begin + 1, values.begin() + end);
}

struct FaceNeighbour {
  std::uint32_t face;
  bool alike; ///< both face the same way
};

/// Over edges with two faces, of each face.
std::vector<std::vector<FaceNeighbour>> neighbours_of(const Mesh& mesh,
                                                      const std::vector<PlacedEdge>& edges) {
  std::vector<std::vector<FaceNeighbour>> neighbours(mesh.face_count());
  for_each_edge(edges, [&](std::span<const PlacedEdge> sides) {
    if (sides.size() != 2 || sides[0].face == sides[1].face) return;
    const bool alike = sides[0].forward != sides[1].forward;
    neighbours[sides[0].face].push_back({sides[1].face, alike});
    neighbours[sides[1].face].push_back({sides[0].face, alike});
  });
  return neighbours;
}

/// A part of a closed model.
struct ClosedPart {
  std::vector<Corners> triangles;
  double volume = 0.0;
  std::optional<BoxTree> tree; ///< made when it is needed
};

bool lies_within(const ClosedPart& part, ClosedPart& other, std::span<const SpacePoint> points) {
  if (part.triangles.empty()) return false;
  if (!other.tree) other.tree.emplace(points, other.triangles);
  return is_inside(points[part.triangles.front()[0]], {points, other.triangles, &*other.tree}) == 1;
}

} // namespace

void turn_face(Mesh& mesh, std::size_t face) {
  const std::uint32_t begin = mesh.face_starts[face], end = mesh.face_starts[face + 1];
  reverse_behind_first(mesh.face_corners, begin, end);
  reverse_behind_first(mesh.corner_texcoords, begin, end);
}

TurnedAlike turn_alike(Mesh& mesh, std::vector<std::uint32_t>& place_of) {
  TurnedAlike done;
  const std::vector<PlacedEdge> edges = placed_edges(mesh, place_of);
  const auto neighbours = neighbours_of(mesh, edges);
  std::vector<std::uint8_t> reached(mesh.face_count(), 0), turns(mesh.face_count(), 0);
  for (std::uint32_t first = 0; first < reached.size(); ++first) {
    if (reached[first] != 0) continue;
    reached[first] = 1;
    std::vector<std::uint32_t> together{first};
    std::size_t turned = 0;
    for (std::size_t at = 0; at < together.size(); ++at)
      for (const FaceNeighbour& beside : neighbours[together[at]]) {
        if (reached[beside.face] != 0) continue;
        reached[beside.face] = 1;
        turns[beside.face] = (turns[together[at]] != 0) == beside.alike ? 1 : 0;
        turned += turns[beside.face];
        together.push_back(beside.face);
      }
    if (2 * turned > together.size())
      for (const std::uint32_t face : together)
        turns[face] = turns[face] != 0 ? 0 : 1;
  }
  for_each_edge(edges, [&](std::span<const PlacedEdge> sides) {
    if (done.one_sided || sides.size() != 2) return;
    const bool alike = sides[0].forward != sides[1].forward;
    if (alike != (turns[sides[0].face] == turns[sides[1].face]))
      done.one_sided = std::pair(sides[0].low, sides[0].high);
  });
  if (done.one_sided) return done;
  for (std::uint32_t face = 0; face < turns.size(); ++face) {
    if (turns[face] == 0) continue;
    turn_face(mesh, face);
    reverse_behind_first(place_of, mesh.face_starts[face], mesh.face_starts[face + 1]);
    ++done.turned;
  }
  return done;
}

std::size_t turn_outwards(Mesh& mesh) {
  std::vector<std::uint32_t> part_of;
  const std::uint32_t count = number_parts(mesh, part_of);
  std::vector<ClosedPart> parts(count);
  std::vector<SpacePoint> points;
  for (Eigen::Index at = 0; at < mesh.vertices.cols(); ++at)
    points.push_back({mesh.vertices(0, at), mesh.vertices(1, at), mesh.vertices(2, at)});
  for_each_triangle(mesh, [&](const Triangle& triangle) {
    parts[part_of[triangle[0]]].triangles.push_back(triangle);
  });
  bool any = false;
  for (ClosedPart& part : parts) {
    part.volume = volume_of(points, part.triangles);
    any = any || part.volume < 0.0;
  }
  if (!any) return 0;
  // Larger parts first: what a part lies in is larger than it.
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::abs(parts[a].volume) > std::abs(parts[b].volume);
  });
  constexpr std::size_t max_looks = 50'000'000; // of tens of thousands of parts, not all pairs
  std::size_t looks = 0;
  std::vector<std::uint8_t> turns(count, 0);
  for (std::size_t at = 0; at < order.size(); ++at) {
    const std::uint32_t part = order[at];
    bool is_within = false;
    // From the smallest that is larger: what lies in several is turned with the innermost.
    for (std::size_t larger = at; larger-- > 0 && !is_within && looks < max_looks; ++looks) {
      is_within = lies_within(parts[part], parts[order[larger]], points);
      if (is_within) turns[part] = turns[order[larger]];
    }
    if (!is_within && parts[part].volume < 0.0) turns[part] = 1;
  }
  std::size_t turned = 0;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    if (turns[part_of[mesh.face_corners[mesh.face_starts[face]]]] != 0) {
      turn_face(mesh, face);
      ++turned;
    }
  return turned;
}

} // namespace nendo::deform
