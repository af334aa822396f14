#include <nendo/deform/field.hpp>

#include "field/field_by_cells.hpp"
#include "field/field_terms.hpp"

namespace nendo::deform {

namespace {

/// From here on, sorting costs less than asking every function about every point.
constexpr Eigen::Index min_by_cells = 256;

bool is_zero(const CsrbfField& field) {
  return field.coefficients.isZero(0.0) && field.polynomial.isZero(0.0);
}

} // namespace

Eigen::Vector3d CsrbfField::displacement_at(const Eigen::Vector3d& x) const noexcept {
  Eigen::Vector3d sum = polynomial_at(*this, x);
  for (Eigen::Index i = 0; i < centres.cols(); ++i)
    add_term(*this, i, x, sum);
  return sum;
}

void displace(const CsrbfField& field, const Points& points, Points& out) {
  if (out.cols() != points.cols()) out.resize(3, points.cols());
  if (is_zero(field)) {
    out = points; // adding +0 would turn a coordinate of -0 into +0
    return;
  }
  if (field.centres.cols() >= min_by_cells && points.cols() > 1) {
    displace_by_cells(field, points, out);
    return;
  }
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d x = points.col(i);
    out.col(i) = x + field.displacement_at(x);
  }
}

void displace(std::span<const CsrbfField> fields, const Points& points, Points& out) {
  out = points;
  Points places; // where the next field is evaluated, if not where the points are
  Points moved;
  for (const CsrbfField& field : fields) {
    if (field.is_halfway) {
      displace(field, out, places);
    } else if (places.size() == 0) {
      displace(field, out, out);
    } else {
      displace(field, places, moved);
      out += moved - places;
      places.resize(3, 0);
    }
  }
}

} // namespace nendo::deform
