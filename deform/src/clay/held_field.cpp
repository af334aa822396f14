#include "clay/held_field.hpp"

#include <cmath>

#include <nendo/deform/wendland.hpp>

#include "clay/slope_grid.hpp"

namespace nendo::deform {

using Eigen::Index;
using Eigen::Vector3d;

namespace {

// Places of one part move together and need no exact fit.
constexpr double held_ridge = 1e-3;

} // namespace

HeldField::HeldField(std::size_t most)
    : places_(3, static_cast<Index>(most)), ways_(places_), coefficients_(places_),
      psi_(static_cast<Index>(most), static_cast<Index>(most)), factor_(psi_) {}

void HeldField::add(std::size_t at, const Vector3d& place, const Vector3d& way) noexcept {
  places_.col(static_cast<Index>(at)) = place;
  ways_.col(static_cast<Index>(at)) = way;
}

/// Cholesky's factorisation by columns, in place: for some dozens of places, and without
/// allocating.
double HeldField::solve(std::size_t count, double radius) noexcept {
  count_ = static_cast<Index>(count);
  radius_ = radius;
  for (Index i = 0; i < count_; ++i)
    for (Index j = 0; j <= i; ++j)
      psi_(i, j) = psi_(j, i) =
          wendland(Wendland::c2, (places_.col(i) - places_.col(j)).norm() / radius);
  for (Index j = 0; j < count_; ++j) {
    auto column = factor_.col(j).segment(j, count_ - j);
    column = psi_.col(j).segment(j, count_ - j);
    column[0] += held_ridge;
    for (Index k = 0; k < j; ++k)
      column -= factor_(j, k) * factor_.col(k).segment(j, count_ - j);
    column /= std::sqrt(column[0]);
  }
  for (Index i = 0; i < count_; ++i) {
    Vector3d sum = ways_.col(i);
    for (Index k = 0; k < i; ++k)
      sum -= factor_(i, k) * coefficients_.col(k);
    coefficients_.col(i) = sum / factor_(i, i);
  }
  for (Index i = count_; i-- > 0;) {
    Vector3d sum = coefficients_.col(i);
    for (Index k = i + 1; k < count_; ++k)
      sum -= factor_(k, i) * coefficients_.col(k);
    coefficients_.col(i) = sum / factor_(i, i);
  }
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  for (Index i = 0; i < count_; ++i) {
    Vector3d sum = Vector3d::Zero();
    for (Index j = 0; j < count_; ++j)
      sum += psi_(i, j) * coefficients_.col(j);
    gram += coefficients_.col(i) * sum.transpose();
  }
  return bound_of_gram(gram, radius);
}

Vector3d HeldField::field_at(const Vector3d& place) const noexcept {
  Vector3d sum = Vector3d::Zero();
  for (Index i = 0; i < count_; ++i)
    sum += wendland(Wendland::c2, (place - places_.col(i)).norm() / radius_) * coefficients_.col(i);
  return sum;
}

} // namespace nendo::deform
