#include "clay/press_problem.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include <nendo/deform/wendland.hpp>

namespace nendo::deform {

using Eigen::Vector3d;

namespace {

// It makes the matrix definite where places coincide, and gives way by a billionth.
constexpr double ridge = 1e-9;
// A tangent's, because places of one part move together and need no exact fit.
constexpr double tangent_ridge = 1e-3;
// Of the largest depth or way: below this, nothing moves any more.
constexpr double enough = 1e-6;
constexpr double sticks_again = 0.8;

} // namespace

PressProblem::PressProblem(std::size_t most)
    : psi_(static_cast<Eigen::Index>(most), static_cast<Eigen::Index>(most)), a_(psi_),
      normals_(3, psi_.rows()), p_(psi_.rows()), l_(psi_.rows()), w_(psi_.rows()),
      t_(psi_.rows(), 3), left_(psi_.rows(), 3) {}

void PressProblem::assign(std::span<const ContactPoint> points, double radius) noexcept {
  radius_ = radius;
  count_ = static_cast<Eigen::Index>(points.size());
  for (Eigen::Index i = 0; i < count_; ++i) {
    const ContactPoint& one = points[static_cast<std::size_t>(i)];
    normals_.col(i) = one.normal;
    p_[i] = one.depth;
    for (Eigen::Index j = 0; j <= i; ++j) {
      const ContactPoint& other = points[static_cast<std::size_t>(j)];
      const double psi = wendland(Wendland::c2, (one.at - other.at).norm() / radius);
      psi_(i, j) = psi_(j, i) = psi;
      a_(i, j) = a_(j, i) = psi * one.normal.dot(other.normal);
    }
    a_(i, i) += ridge;
  }
  l_.head(count_).setZero();
  t_.topRows(count_).setZero();
}

double PressProblem::solve_pressure(double extra) noexcept {
  w_.head(count_) = -p_.head(count_).array() - extra;
  const double least = enough * std::max(0.0, -w_.head(count_).minCoeff());
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double largest = 0.0;
    for (Eigen::Index i = 0; i < count_; ++i) {
      const double after = std::max(0.0, l_[i] - w_[i] / a_(i, i));
      const double change = after - l_[i];
      if (change == 0.0) continue;
      l_[i] = after;
      w_.head(count_) += change * a_.col(i).head(count_);
      largest = std::max(largest, std::abs(change));
    }
    if (largest <= least) break;
  }
  return count_ > 0 ? std::max(0.0, -w_.head(count_).minCoeff()) : 0.0;
}

void PressProblem::add_tangent(Eigen::Index i, const Vector3d& change) noexcept {
  t_.row(i) += change.transpose();
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    left_.col(axis).head(count_) -= change[axis] * psi_.col(i).head(count_);
}

/// Returns whether anything moved.
bool PressProblem::sweep_friction(std::span<const Friction> frictions,
                                  double coefficient) noexcept {
  bool is_moved = false;
  for (Eigen::Index i = 0; i < count_; ++i) {
    const Friction& friction = frictions[static_cast<std::size_t>(i)];
    const double limit = coefficient * (l_[i] + friction.load);
    if (limit <= 0.0) continue;
    const Vector3d normal = normals_.col(i);
    const Vector3d before = t_.row(i);
    const Vector3d left = left_.row(i).transpose() - tangent_ridge * before;
    Vector3d after = before + (left - left.dot(normal) * normal) / (1.0 + tangent_ridge);
    const double force = after.norm();
    std::uint8_t& slips = *friction.slips;
    slips = force > limit * (slips != 0 ? sticks_again : 1.0) ? 1 : 0;
    const double most = limit * (slips != 0 ? sticks_again : 1.0);
    if (force > most) after *= most / force;
    const Vector3d change = after - before;
    if (change.norm() <= enough * limit) continue;
    add_tangent(i, change);
    is_moved = true;
  }
  return is_moved;
}

void PressProblem::solve_friction(std::span<const Friction> frictions,
                                  double coefficient) noexcept {
  for (Eigen::Index i = 0; i < count_; ++i)
    left_.row(i) = frictions[static_cast<std::size_t>(i)].way.transpose();
  for (Eigen::Index i = 0; i < count_; ++i) // what the pressing field does already
    if (l_[i] > 0.0)
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        left_.col(axis).head(count_) -= l_[i] * normals_(axis, i) * psi_.col(i).head(count_);
  for (int sweep = 0; sweep < most_sweeps; ++sweep)
    if (!sweep_friction(frictions, coefficient)) break;
}

Vector3d PressProblem::coefficient(std::size_t i) const noexcept {
  const auto at = static_cast<Eigen::Index>(i);
  return l_[at] * normals_.col(at) + t_.row(at).transpose();
}

double PressProblem::lipschitz_bound() const noexcept {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < count_; ++i) {
    const Vector3d one = coefficient(static_cast<std::size_t>(i));
    if (one.isZero(0.0)) continue;
    Vector3d weighted = 0.5 * one; // the other half by symmetry
    for (Eigen::Index j = 0; j < i; ++j)
      if (psi_(i, j) > 0.0) weighted += psi_(i, j) * coefficient(static_cast<std::size_t>(j));
    const Eigen::Matrix3d product = one * weighted.transpose();
    gram += product + product.transpose();
  }
  constexpr double derivative_norm_squared = 20.0; // of Wendland's C2
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(gram, Eigen::EigenvaluesOnly);
  const double largest = std::max(0.0, solver.eigenvalues()[2]);
  return std::sqrt(derivative_norm_squared * largest) / radius_;
}

} // namespace nendo::deform
