#include "repair/weld.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include <nendo/deform/corner_colours.hpp>

#include "mesh/columns.hpp"
#include "mesh/used_entries.hpp"
#include "repair/stitch.hpp"

namespace nendo::deform {
namespace {

bool has_no_doubles(const std::vector<std::uint32_t>& places) {
  for (std::uint32_t at = 0; at < places.size(); ++at)
    if (places[at] != at) return false;
  return true;
}

/// Numbers vertices so that those of one place and one group share a number, the least of their
/// own.
std::vector<std::uint32_t> places_in_groups(const std::vector<std::uint32_t>& place,
                                            std::span<const std::uint32_t> group_of_vertex) {
  if (group_of_vertex.empty() ||
      std::ranges::adjacent_find(group_of_vertex, std::not_equal_to<>()) == group_of_vertex.end())
    return place;
  return first_alike(place.size(),
                     [&](std::uint32_t at) { return std::pair(place[at], group_of_vertex[at]); });
}

/// Faces with fewer than three places hold nothing together: their vertices become one with the
/// first that another face has there.
void join_thin_faces(const Mesh& mesh, std::span<const std::uint32_t> place, UnionFind& sets) {
  std::vector<std::uint8_t> is_thin(mesh.face_count(), 0);
  std::vector<std::uint32_t> first(place.size(), no_index); // by place
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const auto corners = mesh.corners_of(face);
    is_thin[face] = has_three(corners, [&](std::uint32_t at) { return place[at]; }) ? 0 : 1;
    for (const std::uint32_t vertex : corners)
      if (std::uint32_t& of = first[place[vertex]]; is_thin[face] == 0 && of == no_index)
        of = vertex;
  }
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (const std::uint32_t vertex : mesh.corners_of(face)) {
      if (is_thin[face] == 0) continue;
      const std::uint32_t other = first[place[vertex]];
      sets.join(vertex, other == no_index ? place[vertex] : other);
    }
}

/// A face that has a place twice in a row has one corner there.
void join_repeats(const Mesh& mesh, std::span<const std::uint32_t> place, UnionFind& sets) {
  for_each_face_edge(mesh.face_starts, [&](auto, std::uint32_t at, std::uint32_t next) {
    const std::uint32_t one = mesh.face_corners[at], other = mesh.face_corners[next];
    if (place[one] == place[other]) sets.join(one, other);
  });
}

} // namespace

void keep_corners(Mesh& mesh, std::span<const std::uint8_t> keeps) {
  std::vector<std::uint8_t> faces;
  std::vector<std::uint32_t> starts{0};
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t begin = mesh.face_starts[face], end = mesh.face_starts[face + 1];
    const auto gone = std::count(keeps.begin() + begin, keeps.begin() + end, 0);
    const std::uint32_t kept = end - begin - static_cast<std::uint32_t>(gone);
    faces.push_back(kept > 0 ? 1 : 0);
    if (kept > 0) starts.push_back(starts.back() + kept);
  }
  keep_values(mesh.face_corners, keeps);
  keep_values(mesh.corner_texcoords, keeps);
  for (auto* column : face_columns(mesh.look))
    keep_values(*column, faces);
  mesh.face_starts = std::move(starts);
}

void keep_faces(Mesh& mesh, std::span<const std::uint8_t> keeps,
                std::vector<std::uint32_t>& of_corner) {
  std::vector<std::uint8_t> corners;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    corners.insert(corners.end(), mesh.corners_of(face).size(), keeps[face]);
  if (of_corner.size() == corners.size()) keep_values(of_corner, corners);
  keep_corners(mesh, corners);
}

DroppedCorners renumber_corners(Mesh& mesh, std::span<const std::uint32_t> vertex_of) {
  for (std::uint32_t& corner : mesh.face_corners)
    corner = vertex_of[corner];
  std::vector<std::uint8_t> keeps(mesh.face_corners.size(), 1);
  DroppedCorners dropped;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t begin = mesh.face_starts[face], end = mesh.face_starts[face + 1];
    std::vector<std::uint32_t> own;
    for (std::uint32_t at = begin; at < end; ++at) {
      const std::uint32_t next = at + 1 < end ? at + 1 : begin;
      if (mesh.face_corners[at] == mesh.face_corners[next])
        keeps[at] = 0;
      else
        own.push_back(mesh.face_corners[at]);
    }
    if (!has_three(own)) {
      std::fill(keeps.begin() + begin, keeps.begin() + end, std::uint8_t{0});
      ++dropped.faces;
      continue;
    }
    dropped.corners += end - begin - own.size();
  }
  keep_corners(mesh, keeps);
  return dropped;
}

std::size_t weld_places(Mesh& mesh, std::span<const std::uint32_t> group_of_vertex) {
  std::size_t joined = 0;
  const auto count = mesh.vertex_count();
  const std::vector<std::uint32_t> exact = exact_places(mesh.vertices);
  if (has_no_doubles(exact)) return joined;
  const std::vector<std::uint32_t> place = places_in_groups(exact, group_of_vertex);
  std::vector<std::uint32_t> place_of_corner;
  place_of_corner.reserve(mesh.face_corners.size());
  for (const std::uint32_t vertex : mesh.face_corners)
    place_of_corner.push_back(place[vertex]);
  UnionFind sets(count);
  stitch(mesh, place_of_corner, mesh.face_corners, sets);
  join_repeats(mesh, place, sets);
  join_thin_faces(mesh, place, sets);
  std::vector<std::uint32_t> vertex_of(count);
  std::vector<std::uint8_t> keeps(count, 1);
  const Eigen::Matrix4Xf& colours = mesh.look.vertex_colours;
  bool differ = false;
  for (std::uint32_t at = 0; at < count; ++at) {
    vertex_of[at] = sets.find(at);
    if (vertex_of[at] == at) continue;
    differ = differ || (colours.cols() > 0 && colours.col(vertex_of[at]) != colours.col(at));
    keeps[at] = 0;
    ++joined;
  }
  if (differ) move_colours_to_corners(mesh);
  for (std::uint32_t& corner : mesh.face_corners)
    corner = vertex_of[corner];
  keep_vertices(mesh, keeps);
  return joined;
}

bool is_soup(const Mesh& mesh) {
  if (mesh.face_count() < 2) return false;
  std::vector<std::uint32_t> face_of(mesh.vertex_count(), no_index);
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face)
    for (const std::uint32_t vertex : mesh.corners_of(face)) {
      std::uint32_t& of = face_of[vertex];
      if (of != no_index && of != face) return false;
      of = face;
    }
  return true;
}

} // namespace nendo::deform
