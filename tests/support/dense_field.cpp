#include "support/dense_field.hpp"

#include <cmath>

#include <Eigen/QR>

#include <nendo/deform/wendland.hpp>

namespace nendo::test {

using namespace deform;

namespace {

/// The kernel's matrix with the curl of the curl as derivatives of Wendland's C4 function phi:
///   (-phi'' - phi'/t) I + (phi'' - phi'/t) u u^T / t^2, divided by its value at 0.
Eigen::Matrix3d matrix_at(const CsrbfOptions& options, const Eigen::Vector3d& u) {
  const double t = u.norm();
  if (t >= 1.0) return Eigen::Matrix3d::Zero();
  const double first_over_t = -56.0 / 3.0 * std::pow(1.0 - t, 5) * (5.0 * t + 1.0);
  const double second = 56.0 / 3.0 * std::pow(1.0 - t, 4) * (35.0 * t * t - 4.0 * t - 1.0);
  Eigen::Matrix3d clay = (-second - first_over_t) * Eigen::Matrix3d::Identity();
  if (t > 0.0) clay += (second - first_over_t) / (t * t) * u * u.transpose();
  const double at_zero = 2.0 * 56.0 / 3.0;
  return (1.0 - options.keep_volume) * wendland(options.kernel, t) * Eigen::Matrix3d::Identity() +
         options.keep_volume / at_zero * clay;
}

Points dense_volume_displacements(const CsrbfOptions& options, const Points& starts, double radius,
                                  const Points& displacements, const Points& points) {
  const auto matrices = [&](const Points& at) {
    Eigen::MatrixXd all(3 * at.cols(), 3 * starts.cols());
    for (Eigen::Index i = 0; i < at.cols(); ++i)
      for (Eigen::Index j = 0; j < starts.cols(); ++j)
        all.block<3, 3>(3 * i, 3 * j) = matrix_at(options, (at.col(i) - starts.col(j)) / radius);
    return all;
  };
  const Eigen::VectorXd right = displacements.reshaped();
  const Eigen::VectorXd solution = matrices(starts).householderQr().solve(right);
  return (matrices(points) * solution).reshaped(3, points.cols());
}

} // namespace

Points dense_displacements(const CsrbfOptions& options, const Points& starts, double radius,
                           const Points& displacements, const Points& points) {
  if (options.keep_volume > 0.0)
    return dense_volume_displacements(options, starts, radius, displacements, points);
  const Eigen::Index n = starts.cols();
  const Eigen::Index terms = options.polynomial == Polynomial::linear     ? 4
                             : options.polynomial == Polynomial::constant ? 1
                                                                          : 0;
  const auto row = [&](const Eigen::Vector3d& x) {
    Eigen::RowVectorXd weights(n + terms);
    for (Eigen::Index j = 0; j < n; ++j)
      weights[j] = wendland(options.kernel, (x - starts.col(j)).norm() / radius);
    if (terms > 0) weights[n] = 1.0;
    if (terms > 1) weights.tail<3>() = x.transpose();
    return weights;
  };
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + terms, n + terms);
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(n + terms, 3);
  for (Eigen::Index i = 0; i < n; ++i)
    system.row(i) = row(starts.col(i));
  system.bottomLeftCorner(terms, n) = system.topRightCorner(n, terms).transpose();
  right.topRows(n) = displacements.transpose();
  const Eigen::MatrixX3d solution = system.fullPivHouseholderQr().solve(right);
  Points result(3, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    result.col(i) = (row(points.col(i)) * solution).transpose();
  return result;
}

} // namespace nendo::test
