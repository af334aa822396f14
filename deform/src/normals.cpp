#include <nendo/deform/normals.hpp>

#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

#include <nendo/deform/jacobian.hpp>

namespace nendo::deform {

void turn_normals(const CsrbfField& field, const Points& points, Points& normals) noexcept {
  assert(points.cols() == normals.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Matrix3d jacobian = jacobian_at(field, points.col(i));
    const Eigen::Vector3d x = jacobian.row(0);
    const Eigen::Vector3d y = jacobian.row(1);
    const Eigen::Vector3d z = jacobian.row(2);
    const Eigen::Vector3d normal = normals.col(i);
    const Eigen::Vector3d image(y.cross(z).dot(normal), z.cross(x).dot(normal),
                                x.cross(y).dot(normal));
    const double length = image.norm();
    if (std::isnormal(length)) normals.col(i) = image / length;
  }
}

} // namespace nendo::deform
