#include "solver/volume_assembly.hpp"

#include "solver/ties.hpp"

namespace nendo::deform {

namespace {

/// lower += w Psi Psi^T of one function.
void add_own_volume(const CsrbfOptions& options, const Points& starts, const OwnSupport& own,
                    Eigen::MatrixXd& lower) {
  const double radius = own.support.radius;
  const auto offset = [&](Eigen::Index i) -> Eigen::Vector3d {
    return starts.col(i) - starts.col(own.point);
  };
  for (Eigen::Index j = 0; j < starts.cols(); ++j) {
    if (!(offset(j).squaredNorm() < radius * radius)) continue;
    const Eigen::Matrix3d at_j = own.support.weight * volume_matrix(options, radius, offset(j));
    for (Eigen::Index i = j; i < starts.cols(); ++i) {
      if (!(offset(i).squaredNorm() < radius * radius)) continue;
      lower.block<3, 3>(3 * i, 3 * j) +=
          volume_matrix(options, radius, offset(i)).lazyProduct(at_j);
    }
  }
}

} // namespace

Eigen::Matrix3d volume_matrix(const CsrbfOptions& options, double radius,
                              const Eigen::Vector3d& offset) noexcept {
  const Eigen::Vector3d u = offset / radius;
  const VolumeKernel kernel = volume_kernel(options.kernel, options.keep_volume, u.norm());
  Eigen::Matrix3d matrix = kernel.offset * u * u.transpose();
  matrix.diagonal().array() += kernel.identity;
  return matrix;
}

bool assemble_volume(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                     Eigen::MatrixXd& lower) {
  const Ties ties(options, supports);
  bool merged = false;
  lower.setZero();
  for (const OwnSupport& own : supports.own)
    add_own_volume(options, starts, own, lower);
  for (const Support& support : supports.shared)
    lower.diagonal().array() += options.smoothing * support.weight;
  for (Eigen::Index j = 0; j < starts.cols(); ++j) {
    for (Eigen::Index i = j; i < starts.cols(); ++i) {
      const Eigen::Vector3d offset = starts.col(i) - starts.col(j);
      for (const Support& support : supports.shared)
        if (offset.squaredNorm() < support.radius * support.radius)
          lower.block<3, 3>(3 * i, 3 * j) +=
              support.weight * volume_matrix(options, support.radius, offset);
      const double distance = i == j ? ties.reach() : offset.norm();
      if (i == j || !(distance < ties.reach() || distance == 0.0)) continue;
      const double tie = ties.strength(distance, 0.0, 0.0);
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        lower(3 * i + axis, 3 * i + axis) += tie;
        lower(3 * j + axis, 3 * j + axis) += tie;
        lower(3 * i + axis, 3 * j + axis) -= tie;
      }
      merged = true;
    }
  }
  return merged;
}

Eigen::Vector3d own_volume_coefficient(const CsrbfOptions& options, const Points& starts,
                                       const OwnSupport& own, const Rows& a) noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < starts.cols(); ++i) {
    const Eigen::Vector3d offset = starts.col(i) - starts.col(own.point);
    if (!(offset.squaredNorm() < own.support.radius * own.support.radius)) continue;
    const Eigen::Vector3d at(a(3 * i, 0), a(3 * i + 1, 0), a(3 * i + 2, 0));
    sum += volume_matrix(options, own.support.radius, offset).lazyProduct(at);
  }
  return own.support.weight * sum;
}

} // namespace nendo::deform
