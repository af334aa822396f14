#include "export/morph_normals.hpp"

#include <nendo/deform/vertex_areas.hpp>

namespace nendo::exporting {

using Eigen::Index;

namespace {

// A vertex whose faces have next to no area has no direction that one could turn.
constexpr double min_area_fraction = 1e-12; ///< as a part of the diagonal's square

} // namespace

MorphNormals::MorphNormals(const deform::Mesh& mesh) {
  const double diagonal = deform::diagonal_of(mesh.vertices);
  if (diagonal > 0.0) unit_ = diagonal;
  shape_.vertices = mesh.vertices;
  shape_.face_starts = mesh.face_starts;
  shape_.face_corners = mesh.face_corners;
  rest_areas_ = deform::vertex_areas(shape_, shape_.vertices, unit_);
  lengths_ = rest_areas_.colwise().norm();
  for (double& length : lengths_)
    if (length < min_area_fraction) length = 0.0;
}

/// The areas at rest plus so many times the displacement.
deform::Points MorphNormals::areas(double way_factor, const Eigen::Matrix3Xf& way) const {
  return deform::vertex_areas(shape_, shape_.vertices + way_factor * way.cast<double>(), unit_);
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
