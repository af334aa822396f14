#include <nendo/deform/face_box.hpp>

#include <algorithm>
#include <limits>

namespace nendo::deform {
namespace {

/// 1 for each vertex that a face has.
std::vector<std::uint8_t> vertices_of_faces(const Mesh& mesh) {
  std::vector<std::uint8_t> has_face(mesh.vertex_count(), 0);
  for (const std::uint32_t corner : mesh.face_corners)
    has_face[corner] = 1;
  return has_face;
}

} // namespace

Box box_of_faces(const Mesh& mesh) noexcept {
  if (mesh.face_count() == 0) return finite_box_of(mesh.vertices);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box box{Eigen::Vector3d::Constant(infinity), Eigen::Vector3d::Constant(-infinity)};
  for (const std::uint32_t corner : mesh.face_corners) {
    const auto place = mesh.vertices.col(static_cast<Eigen::Index>(corner));
    if (!place.allFinite()) continue;
    box.lowest = box.lowest.cwiseMin(place);
    box.highest = box.highest.cwiseMax(place);
  }
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
  const auto kept = std::count(has_face.begin(), has_face.end(), 1);
  if (kept == mesh.vertices.cols()) return std::nullopt;
  Mesh faces;
  faces.face_starts = mesh.face_starts;
  faces.offset = mesh.offset;
  faces.vertices.resize(3, kept);
  std::vector<std::uint32_t> number(has_face.size());
  std::uint32_t next = 0;
  for (std::size_t vertex = 0; vertex < has_face.size(); ++vertex) {
    if (has_face[vertex] == 0) continue;
    faces.vertices.col(next) = mesh.vertices.col(static_cast<Eigen::Index>(vertex));
    number[vertex] = next++;
  }
  for (const std::uint32_t corner : mesh.face_corners)
    faces.face_corners.push_back(number[corner]);
  return faces;
}

} // namespace nendo::deform
