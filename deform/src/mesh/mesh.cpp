#include <nendo/deform/mesh.hpp>

#include <algorithm>
#include <cassert>
#include <limits>

#include <Eigen/Geometry>

#include "mesh/columns.hpp"
#include "mesh/used_entries.hpp"

namespace nendo::deform {
namespace {

Box empty_box() noexcept {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {Eigen::Vector3d::Constant(infinity), Eigen::Vector3d::Constant(-infinity)};
}

void add_finite(const Eigen::Vector3d& point, Box& box) noexcept {
  if (!point.allFinite()) return;
  box.lowest = box.lowest.cwiseMin(point);
  box.highest = box.highest.cwiseMax(point);
}

} // namespace

std::vector<std::uint8_t> vertices_of_faces(const Mesh& mesh) {
  std::vector<std::uint8_t> has_face(mesh.vertex_count(), 0);
  for (const std::uint32_t corner : mesh.face_corners)
    has_face[corner] = 1;
  return has_face;
}

void keep_vertices(Mesh& mesh, std::span<const std::uint8_t> keeps) {
  FirstUses kept(keeps.size());
  for (std::uint32_t at = 0; at < keeps.size(); ++at)
    if (keeps[at] != 0) kept(at);
  if (kept.entries().size() == keeps.size()) return;
  for (std::uint32_t& corner : mesh.face_corners) {
    assert(kept.has(corner));
    corner = kept(corner);
  }
  mesh.vertices = columns_at(mesh.vertices, kept.entries());
  keep_values(mesh.detail, keeps);
  mesh.look.vertex_colours = columns_at(mesh.look.vertex_colours, kept.entries());
}

Box finite_box_of(const Points& points) noexcept {
  Box box = empty_box();
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    add_finite(points.col(i), box);
  return box;
}

double diagonal_of(const Points& points) noexcept {
  if (points.cols() == 0) return 0.0;
  const Eigen::Vector3d low = points.rowwise().minCoeff();
  const Eigen::Vector3d high = points.rowwise().maxCoeff();
  return (high - low).stableNorm();
}

std::string_view warning_about(const Mesh& mesh) noexcept {
  if (mesh.face_count() == 0)
    return "has no faces, only vertices: it is a point cloud, of which there is no surface to see; "
           "make one in MeshLab or CloudCompare (Poisson surface reconstruction)";
  const Box box = box_of_faces(mesh);
  if (box.lowest == box.highest) return "has all its vertices in one place, so it has no size";
  return {};
}

Points vertex_areas(const Mesh& mesh, const Points& places, double unit) {
  Points areas = Points::Zero(3, places.cols());
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const auto corners = mesh.corners_of(face);
    const auto edge_from_first = [&](std::size_t at) -> Eigen::Vector3d {
      return (places.col(corners[at]) - places.col(corners[0])) / unit;
    };
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    for (std::size_t at = 1; at + 1 < corners.size(); ++at)
      area += edge_from_first(at).cross(edge_from_first(at + 1));
    for (const std::uint32_t vertex : corners)
      areas.col(vertex) += area;
  }
  return areas;
}

Points vertex_normals(const Mesh& mesh) {
  const double diagonal = diagonal_of(mesh.vertices);
  if (!(diagonal > 0.0)) return Points::Zero(3, mesh.vertices.cols());
  Points normals = vertex_areas(mesh, mesh.vertices, diagonal);
  for (Eigen::Index vertex = 0; vertex < normals.cols(); ++vertex) {
    const double length = normals.col(vertex).stableNorm();
    if (length > 0.0) normals.col(vertex) /= length;
  }
  return normals;
}

Box box_of_faces(const Mesh& mesh) noexcept {
  if (mesh.face_count() == 0) return finite_box_of(mesh.vertices);
  Box box = empty_box();
  for (const std::uint32_t corner : mesh.face_corners)
    add_finite(mesh.vertices.col(static_cast<Eigen::Index>(corner)), box);
  return box;
}

std::vector<std::uint32_t> stray_vertices(const Mesh& mesh) {
  std::vector<std::uint32_t> strays;
  if (mesh.face_count() == 0) return strays;
  const auto has_face = vertices_of_faces(mesh);
  for (std::uint32_t vertex = 0; vertex < has_face.size(); ++vertex)
    if (has_face[vertex] == 0) strays.push_back(vertex);
  return strays;
}

std::optional<Mesh> without_stray_vertices(const Mesh& mesh) {
  if (mesh.face_count() == 0) return std::nullopt;
  const auto has_face = vertices_of_faces(mesh);
  if (std::find(has_face.begin(), has_face.end(), 0) == has_face.end()) return std::nullopt;
  Mesh faces;
  faces.vertices = mesh.vertices;
  faces.face_starts = mesh.face_starts;
  faces.face_corners = mesh.face_corners;
  faces.offset = mesh.offset;
  keep_vertices(faces, has_face);
  return faces;
}

} // namespace nendo::deform
