#pragma once
// The columns of a mesh, as algorithms read and copy them: points as plain numbers, and what each
// corner and each face has. Also the edges of faces, and faces with equal corners.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <iterator>
#include <span>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "geometry/space.hpp"

namespace nendo::deform {

inline SpacePoint space_point(const Points& points, std::size_t at) noexcept {
  const double* const of = points.data() + 3 * at;
  return {of[0], of[1], of[2]};
}

inline SpacePoint space_point(const Eigen::Vector3d& vector) noexcept {
  return {vector[0], vector[1], vector[2]};
}

inline std::vector<SpacePoint> space_points(const Points& points) {
  std::vector<SpacePoint> all(static_cast<std::size_t>(points.cols()));
  for (std::size_t at = 0; at < all.size(); ++at)
    all[at] = space_point(points, at);
  return all;
}

/// Returns the same as columns.
inline Points points_of(std::span<const SpacePoint> points) {
  return Eigen::Map<const Points>(points.empty() ? nullptr : points.front().data(), 3,
                                  static_cast<Eigen::Index>(points.size()));
}

/// Returns the columns with one entry per face. Each may be empty.
inline std::array<std::vector<std::uint32_t>*, 3> face_columns(Appearance& look) noexcept {
  return {&look.face_materials, &look.groups.of_face, &look.objects.of_face};
}
inline std::array<const std::vector<std::uint32_t>*, 3>
face_columns(const Appearance& look) noexcept {
  return {&look.face_materials, &look.groups.of_face, &look.objects.of_face};
}

/// Returns of each of `count` entries the first one with the same key(entry). Allocates.
template <class Key>
std::vector<std::uint32_t> first_alike(std::size_t count, const Key& key) {
  std::vector<std::uint32_t> order = all_indices(count), first(count);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t at = 0; at < count; ++at)
    first[order[at]] =
        at > 0 && key(order[at]) == key(order[at - 1]) ? first[order[at - 1]] : order[at];
  return first;
}

/// Calls visit(face, corner, next corner) for each edge of each face.
template <class Visit>
void for_each_face_edge(std::span<const std::uint32_t> face_starts, const Visit& visit) {
  for (std::uint32_t face = 0; face + 1 < face_starts.size(); ++face) {
    const std::uint32_t begin = face_starts[face], end = face_starts[face + 1];
    for (std::uint32_t at = begin; at < end; ++at)
      visit(face, at, at + 1 < end ? at + 1 : begin);
  }
}

/// Returns whether a corner follows itself; the first corner follows the last.
inline bool repeats_corner(std::span<const std::uint32_t> corners) noexcept {
  return (corners.size() > 1 && corners.front() == corners.back()) ||
         std::ranges::adjacent_find(corners) != corners.end();
}

/// Returns whether three of the values, as `project` shows them, differ from each other.
template <class Values, class Project = std::identity>
bool has_three(const Values& values, const Project& project = {}) {
  const auto first = std::begin(values);
  auto second = first;
  for (auto at = first; at != std::end(values); ++at) {
    if (project(*at) == project(*first) || project(*at) == project(*second)) continue;
    if (second != first) return true;
    second = at;
  }
  return false;
}

/// Returns 1 for each vertex that a face has, and 0 for the others. Allocates.
std::vector<std::uint8_t> vertices_of_faces(const Mesh& mesh);

/// Keeps the vertices for which `keeps` is not 0. No face may have another one.
void keep_vertices(Mesh& mesh, std::span<const std::uint8_t> keeps);

/// Returns the columns with these numbers, or none if there are none at all.
template <class Columns>
Columns columns_at(const Columns& columns, const std::vector<std::uint32_t>& numbers) {
  if (columns.cols() == 0) return columns;
  return columns(Eigen::all, numbers);
}

template <class Columns>
void append_columns(const Columns& more, Columns& to) {
  to.conservativeResize(Eigen::NoChange, to.cols() + more.cols());
  to.rightCols(more.cols()) = more;
}

inline void append_corner(const Mesh& from, std::uint32_t corner, Mesh& to) {
  to.face_corners.push_back(from.face_corners[corner]);
  if (!from.corner_texcoords.empty()) to.corner_texcoords.push_back(from.corner_texcoords[corner]);
}

/// Ends the face whose corners were appended. It gets the entries of `face`.
inline void end_face(const Mesh& from, std::size_t face, Mesh& to) {
  to.face_starts.push_back(to_index(to.face_corners.size()));
  for (std::size_t k = 0; k < 3; ++k)
    if (const auto& column = *face_columns(from.look)[k]; !column.empty())
      face_columns(to.look)[k]->push_back(column[face]);
}

} // namespace nendo::deform
