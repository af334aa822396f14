#include <nendo/deform/field.hpp>

#include <cmath>

namespace nendo::deform {

namespace {

bool is_zero(const CsrbfField& field) {
  return field.coefficients.isZero(0.0) && field.polynomial.isZero(0.0);
}

} // namespace

Eigen::Vector3d CsrbfField::displacement_at(const Eigen::Vector3d& x) const noexcept {
  Eigen::Vector3d sum = polynomial.col(0) + polynomial.rightCols<3>() * x;
  for (Eigen::Index i = 0; i < centres.cols(); ++i) {
    const double squared = (x - centres.col(i)).squaredNorm();
    if (!(squared < radii[i] * radii[i])) continue;
    sum += wendland(kernel, std::sqrt(squared) / radii[i]) * coefficients.col(i);
  }
  return sum;
}

void displace(const CsrbfField& field, const Points& points, Points& out) {
  if (out.cols() != points.cols()) out.resize(3, points.cols());
  if (is_zero(field)) {
    out = points; // adding +0 would turn a coordinate of -0 into +0
    return;
  }
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d x = points.col(i);
    out.col(i) = x + field.displacement_at(x);
  }
}

} // namespace nendo::deform
