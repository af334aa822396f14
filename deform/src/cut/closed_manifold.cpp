#include <nendo/deform/closed_manifold.hpp>

#include <algorithm>

#include <nendo/deform/offset.hpp>
#include <nendo/deform/triangles.hpp>

#include "mesh/columns.hpp"
#include "mesh/surface_mesh.hpp"

namespace nendo::deform {
namespace {

/// Remembers the first fault, and counts those that are like it.
void note_fault(ManifoldFault fault, std::uint32_t face, std::uint32_t from, std::uint32_t to,
                ManifoldCheck& check) noexcept {
  if (check.fault == ManifoldFault::none) check = {fault, 0, face, from, to};
  if (check.fault == fault) ++check.count;
}

/// Sorts the corners, and returns one that is there twice, or the end.
auto find_repeated(std::span<const std::uint32_t> corners, std::vector<std::uint32_t>& sorted) {
  sorted.assign(corners.begin(), corners.end());
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end());
}

void check_faces(std::span<const std::uint32_t> starts, std::span<const std::uint32_t> corners,
                 ManifoldCheck& check) {
  std::vector<std::uint32_t> sorted;
  for (std::uint32_t face = 0; face + 1 < starts.size(); ++face) {
    const auto own = corners.subspan(starts[face], starts[face + 1] - starts[face]);
    const std::uint32_t vertex = own.empty() ? 0 : own[0];
    if (own.size() < 3) {
      note_fault(ManifoldFault::few_corners, face, vertex, vertex, check);
      continue;
    }
    if (own.size() == 3 && own[0] != own[1] && own[1] != own[2] && own[2] != own[0]) continue;
    const auto twice = find_repeated(own, sorted);
    if (twice != sorted.end())
      note_fault(ManifoldFault::repeated_corner, face, *twice, *twice, check);
  }
}

/// An edge's fault is counted once, at the least of the faces that it concerns.
void check_edges(std::span<const std::uint32_t> starts, std::span<const std::uint32_t> corners,
                 const HalfEdges& edges, ManifoldCheck& check) {
  for (std::uint32_t face = 0; face + 1 < starts.size(); ++face)
    for (std::uint32_t edge = starts[face]; edge < starts[face + 1]; ++edge) {
      const std::uint32_t from = corners[edge];
      const std::uint32_t to = corners[edges.next[edge]];
      const auto count = [&](std::uint32_t begin, std::uint32_t end, bool& is_first) {
        std::uint32_t found = 0;
        for (const std::uint32_t other : edges.out[begin])
          if (corners[edges.next[other]] == end) {
            ++found;
            is_first = is_first && other >= edge;
          }
        return found;
      };
      bool is_first = true;
      const std::uint32_t same = count(from, to, is_first);
      const std::uint32_t opposite = count(to, from, is_first);
      if (!is_first || (same == 1 && opposite == 1)) continue;
      const ManifoldFault fault = same + opposite == 1  ? ManifoldFault::open_edge
                                  : same + opposite > 2 ? ManifoldFault::crowded_edge
                                                        : ManifoldFault::turned_faces;
      note_fault(fault, face, from, to, check);
    }
}

void check_fans(std::span<const std::uint32_t> starts, const HalfEdges& edges,
                ManifoldCheck& check) {
  for (std::uint32_t vertex = 0; vertex + 1 < edges.out.starts.size(); ++vertex) {
    const std::size_t count = edges.out[vertex].size();
    if (count == 0) continue;
    const std::uint32_t first = edges.out[vertex][0];
    std::uint32_t edge = first;
    std::size_t turned = 0;
    do {
      edge = edges.twin[edges.last[edge]];
      ++turned;
    } while (edge != first && turned <= count);
    if (turned == count) continue;
    const auto face = std::upper_bound(starts.begin(), starts.end(), first) - starts.begin() - 1;
    note_fault(ManifoldFault::pinched_vertex, static_cast<std::uint32_t>(face), vertex, vertex,
               check);
  }
}

} // namespace

ManifoldCheck check_closed_manifold(std::span<const std::uint32_t> face_starts,
                                    std::span<const std::uint32_t> face_corners,
                                    const HalfEdges& edges) {
  if (face_starts.size() < 2) return {ManifoldFault::no_faces, 1, 0, 0, 0};
  ManifoldCheck check;
  check_faces(face_starts, face_corners, check);
  if (!check) return check;
  // Of two edges alike, only their twin sees both.
  if (std::find(edges.twin.begin(), edges.twin.end(), no_index) != edges.twin.end())
    check_edges(face_starts, face_corners, edges, check);
  if (check) check_fans(face_starts, edges, check);
  return check;
}

ManifoldCheck check_closed_manifold(std::span<const std::uint32_t> face_starts,
                                    std::span<const std::uint32_t> face_corners,
                                    std::size_t vertices) {
  return check_closed_manifold(face_starts, face_corners,
                               half_edges_of(face_starts, face_corners, vertices));
}

namespace {

/// Returns whether a face goes through a vertex twice, but not twice in a row: as one with a
/// bridge.
bool has_bridge(const Mesh& mesh, std::size_t face, std::vector<std::uint32_t>& sorted) {
  const auto corners = mesh.corners_of(face);
  return corners.size() >= 4 && !repeats_corner(corners) &&
         find_repeated(corners, sorted) != sorted.end();
}

} // namespace

ManifoldCheck check_closed_manifold(const Mesh& mesh) {
  const auto vertices = mesh.vertex_count();
  ManifoldCheck check = check_closed_manifold(mesh.face_starts, mesh.face_corners, vertices);
  if (check.fault != ManifoldFault::repeated_corner) return check;
  std::vector<bool> is_bridged(mesh.face_count(), false);
  std::vector<std::uint32_t> sorted;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    is_bridged[face] = has_bridge(mesh, face, sorted);
  const Mesh split = with_split_faces(mesh, mesh.vertices, is_bridged);
  check = check_closed_manifold(split.face_starts, split.face_corners, vertices);
  if (check) return check;
  // Of the piece, the face that it is from.
  FaceTriangles triangles(mesh);
  std::size_t pieces = 0;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    pieces += is_bridged[face] ? triangles.of(face).size() : 1;
    if (check.face >= pieces) continue;
    check.face = face;
    break;
  }
  return check;
}

std::string describe(const ManifoldCheck& check, const Mesh& mesh) {
  const auto vertex = [&] { return place_text(mesh, check.from); };
  const auto edge = [&] {
    return "the edge between " + place_text(mesh, check.from) + " and " +
           place_text(mesh, check.to);
  };
  const auto face = [&] { return "face " + std::to_string(check.face + 1); };
  std::string words;
  switch (check.fault) {
  case ManifoldFault::none:
    return {};
  case ManifoldFault::no_faces:
    return "has no faces";
  case ManifoldFault::few_corners:
    words = "has fewer than three corners in " + face();
    break;
  case ManifoldFault::repeated_corner:
    words = "has a corner twice in " + face() + " at " + vertex();
    break;
  case ManifoldFault::open_edge:
    words = "is open at " + edge();
    break;
  case ManifoldFault::crowded_edge:
    words = "has more than two faces at " + edge();
    break;
  case ManifoldFault::turned_faces:
    words = "has faces that face opposite ways at " + edge();
    break;
  case ManifoldFault::pinched_vertex:
    words = "has faces that touch only at the vertex " + vertex();
    break;
  }
  if (check.count > 1)
    words +=
        ", and at " + std::to_string(check.count - 1) + (check.count > 2 ? " others" : " other");
  return words;
}

} // namespace nendo::deform
