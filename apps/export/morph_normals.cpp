#include "export/morph_normals.hpp"

#include <Eigen/Geometry>

namespace nendo::exporting {

using Eigen::Index;

namespace {

// A vertex whose faces have next to no area has no direction that one could turn.
constexpr double min_area_fraction = 1e-12; ///< of the square of the diagonal

} // namespace

MorphNormals::MorphNormals(const deform::Mesh& mesh) {
  const double diagonal = deform::diagonal_of(mesh.vertices);
  scale_ = diagonal > 0.0 ? 1.0 / diagonal : 1.0;
  const Eigen::Vector3d origin =
      mesh.vertices.cols() > 0 ? Eigen::Vector3d(mesh.vertices.col(0)) : Eigen::Vector3d::Zero();
  shape_.vertices = (mesh.vertices.colwise() - origin) * scale_;
  shape_.face_starts = mesh.face_starts;
  shape_.face_corners = mesh.face_corners;
  rest_areas_ = areas(0.0, {});
  lengths_ = rest_areas_.colwise().norm();
  for (double& length : lengths_)
    if (length < min_area_fraction) length = 0.0;
}

/// The sums of the areas of each vertex's faces, at rest plus so many times the displacement.
deform::Points MorphNormals::areas(double way_factor, const Eigen::Matrix3Xf& way) const {
  deform::Points sums = deform::Points::Zero(3, shape_.vertices.cols());
  const auto place = [&](std::uint32_t corner) -> Eigen::Vector3d {
    const auto vertex = static_cast<Index>(shape_.face_corners[corner]);
    if (way_factor == 0.0) return shape_.vertices.col(vertex);
    return shape_.vertices.col(vertex) + way_factor * scale_ * way.col(vertex).cast<double>();
  };
  for (std::size_t face = 0; face < shape_.face_count(); ++face) {
    const std::uint32_t begin = shape_.face_starts[face];
    const std::uint32_t end = shape_.face_starts[face + 1];
    const Eigen::Vector3d first = place(begin);
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    for (std::uint32_t at = begin + 1; at + 1 < end; ++at)
      area += (place(at) - first).cross(place(at + 1) - first);
    for (std::uint32_t at = begin; at < end; ++at)
      sums.col(shape_.face_corners[at]) += area;
  }
  return sums;
}

Eigen::Matrix3Xf MorphNormals::rest() const {
  Eigen::Matrix3Xf normals(3, rest_areas_.cols());
  for (Index vertex = 0; vertex < normals.cols(); ++vertex)
    normals.col(vertex) =
        lengths_[vertex] > 0.0
            ? Eigen::Vector3f((rest_areas_.col(vertex) / lengths_[vertex]).cast<float>())
            : Eigen::Vector3f(Eigen::Vector3f::UnitY()); // any will do
  return normals;
}

Eigen::Matrix3Xf MorphNormals::divided(const deform::Points& turn) const {
  Eigen::Matrix3Xf turns = Eigen::Matrix3Xf::Zero(3, turn.cols());
  for (Index vertex = 0; vertex < turns.cols(); ++vertex)
    if (lengths_[vertex] > 0.0)
      turns.col(vertex) = (turn.col(vertex) / lengths_[vertex]).cast<float>();
  return turns;
}

Eigen::Matrix3Xf MorphNormals::turn_to(const Eigen::Matrix3Xf& way) const {
  return divided(areas(1.0, way) - rest_areas_);
}

Eigen::Matrix3Xf MorphNormals::turn_along(const Eigen::Matrix3Xf& way) const {
  // A polynomial of degree two has its derivative as the central difference, whatever the step.
  return divided((areas(1.0, way) - areas(-1.0, way)) / 2.0);
}

} // namespace nendo::exporting
