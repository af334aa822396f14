#include <nendo/deform/type1.hpp>

#include <cassert>
#include <utility>

namespace nendo::deform {

Type1Deformer::Type1Deformer(Points rest, Eigen::Index control_points, double radius,
                             CsrbfOptions options)
    : rest_(std::move(rest)), starts_(Points::Zero(3, control_points)),
      displacements_(Points::Zero(3, control_points)),
      radii_(Eigen::VectorXd::Constant(control_points, radius)),
      solver_(options), field_{.kernel = options.kernel,
                               .centres = starts_,
                               .radii = radii_,
                               .coefficients = displacements_} {
  solver_.reserve(control_points);
}

FieldStatus Type1Deformer::grab(const Points& starts) {
  assert(starts.cols() == starts_.cols());
  const FieldStatus status = solver_.build(starts, radii_);
  if (is_solved(status)) {
    starts_ = starts;
    grabbed_ = true;
  } else if (grabbed_ && status == FieldStatus::singular) {
    solver_.build(starts_, radii_); // the failed build took the place of the good one
  }
  return status;
}

FieldStatus Type1Deformer::apply(const Points& ends, Points& out) {
  assert(ends.cols() == starts_.cols());
  FieldStatus status = FieldStatus::singular;
  if (grabbed_) {
    displacements_ = ends - starts_;
    status = solver_.solve(displacements_, field_);
  }
  displace(field_, rest_, out);
  return status;
}

FieldStatus Type1Deformer::commit(const Points& ends) {
  const FieldStatus status = grab(ends);
  if (!is_solved(status)) return status;
  displace(field_, rest_, rest_);
  field_.coefficients.setZero();
  field_.polynomial.setZero();
  return status;
}

} // namespace nendo::deform
