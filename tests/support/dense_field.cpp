#include "support/dense_field.hpp"

#include <Eigen/QR>

#include <nendo/deform/wendland.hpp>

namespace nendo::test {

using namespace deform;

Points dense_displacements(const CsrbfOptions& options, const Points& starts, double radius,
                           const Points& displacements, const Points& points) {
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
