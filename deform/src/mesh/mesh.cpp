#include <nendo/deform/mesh.hpp>

#include <limits>

#include <Eigen/Geometry>
#include <nendo/deform/face_box.hpp>
#include <nendo/deform/vertex_areas.hpp>

namespace nendo::deform {

Box finite_box_of(const Points& points) noexcept {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box box{Eigen::Vector3d::Constant(infinity), Eigen::Vector3d::Constant(-infinity)};
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (!points.col(i).allFinite()) continue;
    box.lowest = box.lowest.cwiseMin(points.col(i));
    box.highest = box.highest.cwiseMax(points.col(i));
  }
  return box;
}

double diagonal_of(const Points& points) noexcept {
  if (points.cols() == 0) return 0.0;
  const Eigen::Vector3d low = points.rowwise().minCoeff();
  const Eigen::Vector3d high = points.rowwise().maxCoeff();
  return (high - low).stableNorm();
}

std::string_view remark_on(const Mesh& mesh) noexcept {
  if (mesh.face_count() == 0)
    return "has no faces, only vertices: it is a point cloud, of which there is no surface to see; "
           "make one in MeshLab or CloudCompare (Poisson surface reconstruction)";
  const Box box = box_of_faces(mesh);
  if (box.lowest == box.highest) return "has all its vertices in one place, so it has no size";
  return {};
}

Points vertex_areas(const Mesh& mesh, const Points& places, double unit) {
  Points areas = Points::Zero(3, places.cols());
  const auto corner = [&](std::uint32_t at) {
    return static_cast<Eigen::Index>(mesh.face_corners[at]);
  };
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t begin = mesh.face_starts[face];
    const std::uint32_t end = mesh.face_starts[face + 1];
    const auto edge_from_first = [&](std::uint32_t at) -> Eigen::Vector3d {
      return (places.col(corner(at)) - places.col(corner(begin))) / unit;
    };
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    for (std::uint32_t at = begin + 1; at + 1 < end; ++at)
      area += edge_from_first(at).cross(edge_from_first(at + 1));
    for (std::uint32_t at = begin; at < end; ++at)
      areas.col(corner(at)) += area;
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

} // namespace nendo::deform
