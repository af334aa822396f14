#pragma once
// Fits fields in one line, and computes what they do to points.

#include <doctest/doctest.h>

#include <nendo/deform/csrbf.hpp>

namespace nendo::test {

/// Returns a fitted field. `of` is radii or supports, as build() takes them.
template <class Of>
deform::CsrbfField fitted(const deform::CsrbfOptions& options, const deform::Points& starts,
                          const Of& of, const deform::Points& displacements,
                          deform::FieldStatus expected = deform::FieldStatus::ok) {
  deform::CsrbfSolver solver(options);
  deform::CsrbfField field;
  CHECK(solver.build(starts, of) == expected);
  CHECK(solver.solve(displacements, field) == expected);
  return field;
}

inline deform::CsrbfField fitted(const deform::CsrbfOptions& options, const deform::Points& starts,
                                 double radius, const deform::Points& displacements,
                                 deform::FieldStatus expected = deform::FieldStatus::ok) {
  return fitted(options, starts, Eigen::VectorXd::Constant(starts.cols(), radius).eval(),
                displacements, expected);
}

/// Returns s(x), a column for each point.
inline deform::Points values(const deform::CsrbfField& field, const deform::Points& points) {
  deform::Points moved;
  displace(field, points, moved);
  return moved - points;
}

inline double largest(const deform::Points& points) {
  return points.cwiseAbs().maxCoeff();
}

} // namespace nendo::test
