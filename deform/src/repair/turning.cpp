// Orients faces: alike over shared edges, and then each part outwards.

#include "repair/steps.hpp"

#include <algorithm>
#include <cmath>

#include <nendo/deform/repair.hpp>
#include <nendo/deform/triangles.hpp>

#include "cut/cut_assembly.hpp"
#include "join/crossings.hpp"
#include "mesh/columns.hpp"
#include "repair/stitch.hpp"

namespace nendo::deform {
namespace {

template <class Values>
void reverse_after_first(Values& values, std::uint32_t begin, std::uint32_t end) {
  if (values.empty() || end - begin < 2) return;
  std::reverse(values.begin() + begin + 1, values.begin() + end);
}

/// Reverses a face: its corners, with all that belongs to them. The first corner stays the first.
void turn_face(Mesh& mesh, std::size_t face) {
  const std::uint32_t begin = mesh.face_starts[face], end = mesh.face_starts[face + 1];
  reverse_after_first(mesh.face_corners, begin, end);
  reverse_after_first(mesh.corner_texcoords, begin, end);
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

/// `reached_from` is the same for faces that hang together.
void find_one_sided(const std::vector<PlacedEdge>& edges, const std::vector<std::uint8_t>& turns,
                    const std::vector<std::uint32_t>& reached_from, TurnedAlike& done) {
  std::vector<std::uint8_t> is_one_sided(turns.size(), 0);
  for_each_edge(edges, [&](std::span<const PlacedEdge> sides) {
    if (sides.size() != 2) return;
    const bool alike = sides[0].forward != sides[1].forward;
    if (alike == (turns[sides[0].face] == turns[sides[1].face])) return;
    if (!done.one_sided) done.one_sided = std::pair(sides[0].low, sides[0].high);
    is_one_sided[reached_from[sides[0].face]] = 1;
  });
  for (std::uint32_t face = 0; face < turns.size(); ++face)
    if (is_one_sided[reached_from[face]] != 0) done.one_sided_faces.push_back(face);
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

/// The parts of a closed mesh; whether one of them has a negative volume.
struct ClosedParts {
  std::vector<std::uint32_t> part_of; ///< each vertex
  std::vector<SpacePoint> points;
  std::vector<ClosedPart> parts;
  bool any_inwards = false;

  explicit ClosedParts(const Mesh& mesh) : points(space_points(mesh.vertices)) {
    parts.resize(number_parts(mesh, part_of));
    for_each_triangle(mesh, [&](const Triangle& triangle) {
      parts[part_of[triangle[0]]].triangles.push_back(triangle);
    });
    for (ClosedPart& part : parts) {
      part.volume = volume_of(points, part.triangles);
      any_inwards = any_inwards || part.volume < 0.0;
    }
  }
};

/// Of each part whether it is to be turned.
std::vector<std::uint8_t> inward_parts(ClosedParts& of) {
  std::vector<ClosedPart>& parts = of.parts;
  // Larger parts first: what a part lies in is larger than it.
  std::vector<std::uint32_t> order = all_indices(parts.size());
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::abs(parts[a].volume) > std::abs(parts[b].volume);
  });
  constexpr std::size_t max_looks = 50'000'000; // of tens of thousands of parts, not all pairs
  std::size_t looks = 0;
  std::vector<std::uint8_t> turns(parts.size(), 0);
  for (std::size_t at = 0; at < order.size(); ++at) {
    const std::uint32_t part = order[at];
    bool is_within = false;
    // From the smallest that is larger: what lies in several is turned with the innermost.
    for (std::size_t larger = at; larger-- > 0 && !is_within && looks < max_looks; ++looks) {
      is_within = lies_within(parts[part], parts[order[larger]], of.points);
      if (is_within) turns[part] = turns[order[larger]];
    }
    if (!is_within && parts[part].volume < 0.0) turns[part] = 1;
  }
  return turns;
}

/// The faces of a closed mesh that are to be turned.
std::vector<std::size_t> inward_faces(const Mesh& mesh) {
  ClosedParts closed(mesh);
  if (!closed.any_inwards) return {};
  const std::vector<std::uint8_t> turns = inward_parts(closed);
  std::vector<std::size_t> inwards;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    if (turns[closed.part_of[mesh.corners_of(face)[0]]] != 0) inwards.push_back(face);
  return inwards;
}

} // namespace

TurnedAlike turn_alike(Mesh& mesh, std::vector<std::uint32_t>& place_of) {
  TurnedAlike done;
  const std::vector<PlacedEdge> edges = placed_edges(mesh, place_of);
  const auto neighbours = neighbours_of(mesh, edges);
  std::vector<std::uint8_t> turns(mesh.face_count(), 0);
  std::vector<std::uint32_t> reached_from(mesh.face_count(), no_index);
  for (std::uint32_t first = 0; first < turns.size(); ++first) {
    if (reached_from[first] != no_index) continue;
    reached_from[first] = first;
    std::vector<std::uint32_t> together{first};
    std::size_t turned = 0;
    for (std::size_t at = 0; at < together.size(); ++at)
      for (const FaceNeighbour& beside : neighbours[together[at]]) {
        if (reached_from[beside.face] != no_index) continue;
        reached_from[beside.face] = first;
        turns[beside.face] = (turns[together[at]] != 0) == beside.alike ? 1 : 0;
        turned += turns[beside.face];
        together.push_back(beside.face);
      }
    if (2 * turned > together.size())
      for (const std::uint32_t face : together)
        turns[face] = turns[face] != 0 ? 0 : 1;
  }
  find_one_sided(edges, turns, reached_from, done);
  if (done.one_sided) return done;
  for (std::uint32_t face = 0; face < turns.size(); ++face) {
    if (turns[face] == 0) continue;
    turn_face(mesh, face);
    reverse_after_first(place_of, mesh.face_starts[face], mesh.face_starts[face + 1]);
    ++done.turned;
  }
  return done;
}

std::size_t turn_outwards(Mesh& mesh) {
  const std::vector<std::size_t> inwards = inward_faces(mesh);
  for (const std::size_t face : inwards)
    turn_face(mesh, face);
  return inwards.size();
}

std::size_t count_inward_faces(const Mesh& mesh) {
  return inward_faces(mesh).size();
}

} // namespace nendo::deform
