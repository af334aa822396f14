#include <nendo/deform/jacobian.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <nendo/deform/volume_kernel.hpp>

#include "simd/field_kernels.hpp"

namespace nendo::deform {

namespace {

/// -psi''(0): the squared norm, in the kernel's native space, of the functional that takes a
/// function's derivative at a point, for r = 1. Infinite for c0.
double derivative_norm_squared(Wendland kernel) noexcept {
  if (kernel == Wendland::c0) return std::numeric_limits<double>::infinity();
  return -slope_factor(kernel); // the rest of psi' / t is 1 at t = 0
}

/// At least the largest eigenvalue, and at most 3^(1/8) of it, of a symmetric matrix without
/// negative ones.
double largest_eigenvalue_bound(Eigen::Matrix3d matrix) noexcept {
  const double scale = matrix.cwiseAbs().maxCoeff();
  if (!(scale > 0.0)) return 0.0;
  matrix /= scale;
  for (int squaring = 0; squaring < 2; ++squaring)
    matrix = (matrix * matrix).eval();
  return scale * std::sqrt(std::sqrt(matrix.norm()));
}

/// Of the kernel with r = 1.
double steepest_slope(const CsrbfField& field) noexcept {
  const double slope = std::abs(wendland_slope(field.kernel, wendland_steepest_at(field.kernel)));
  if (field.keep_volume <= 0.0) return slope;
  return (1.0 - field.keep_volume) * slope + field.keep_volume * volume_kernel_steepest;
}

double steepest(const CsrbfField& field, Eigen::Index i) noexcept {
  return field.coefficients.col(i).norm() * steepest_slope(field) / field.radii[i];
}

/// Let c_i be the centre nearest to x: then |x - c_j| >= |c_i - c_j| / 2, and beyond its steepest
/// place psi is the flatter, the farther.
double sum_bound(const CsrbfField& field) noexcept {
  const double peak = wendland_steepest_at(field.kernel);
  double largest = 0.0;
  for (Eigen::Index i = 0; i < field.centres.cols(); ++i) {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < field.centres.cols(); ++j) {
      const double apart = (field.centres.col(i) - field.centres.col(j)).norm();
      const double t = 0.5 * apart / field.radii[j];
      if (!(t < 1.0)) continue;
      const double slope = field.keep_volume > 0.0
                               ? steepest_slope(field) // it does not fall everywhere
                               : wendland_slope(field.kernel, std::max(t, peak));
      sum += field.coefficients.col(j).norm() * std::abs(slope) / field.radii[j];
    }
    largest = std::max(largest, sum);
  }
  return largest;
}

/// Of the centres with the same radius as c_first: v.s is in the kernel's native space, with the
/// squared norm v^T (sum_ij a_i a_j^T psi_ij) v; the derivative of any f in it along a unit vector
/// is at most |f| sqrt(-psi''(0)) / r, by Cauchy and Schwarz (Wendland, Scattered Data
/// Approximation, chapters 10 and 11).
double native_bound(const CsrbfField& field, Eigen::Index first) noexcept {
  const double radius = field.radii[first];
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  double sum = 0.0;
  double steepest_sum = 0.0;
  double count = 0.0;
  for (Eigen::Index i = first; i < field.centres.cols(); ++i) {
    if (field.radii[i] != radius) continue;
    Eigen::Vector3d weighted = 0.5 * field.coefficients.col(i); // the other half by symmetry
    for (Eigen::Index j = first; j < i; ++j) {
      if (field.radii[j] != radius) continue;
      const double apart = (field.centres.col(i) - field.centres.col(j)).norm();
      weighted += wendland(field.kernel, apart / radius) * field.coefficients.col(j);
    }
    const Eigen::Matrix3d product = field.coefficients.col(i) * weighted.transpose();
    gram += product + product.transpose();
    sum += field.coefficients.col(i).norm();
    steepest_sum += steepest(field, i);
    count += 1.0;
  }
  // What rounding may have taken away where large coefficients cancel.
  gram.diagonal().array() += 8.0 * count * std::numeric_limits<double>::epsilon() * sum * sum;
  const double native =
      std::sqrt(derivative_norm_squared(field.kernel) * largest_eigenvalue_bound(gram)) / radius;
  return std::min(native, steepest_sum);
}

double native_bound(const CsrbfField& field) noexcept {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < field.radii.size(); ++i) {
    bool is_first = true;
    for (Eigen::Index j = 0; is_first && j < i; ++j)
      is_first = field.radii[j] != field.radii[i];
    if (is_first) sum += native_bound(field, i);
  }
  return sum;
}

} // namespace

double lipschitz_bound(const CsrbfField& field) noexcept {
  const double affine = field.polynomial.rightCols<3>().norm();
  const double sum = sum_bound(field);
  // The native norm of matrix-valued kernels is another one.
  const double native =
      field.keep_volume > 0.0 ? std::numeric_limits<double>::infinity() : native_bound(field);
  const double bound = affine + std::min(sum, native);
  const bool finite = std::isfinite(affine + sum) && field.coefficients.allFinite();
  return finite ? bound : std::numeric_limits<double>::infinity();
}

void DeterminantProbe::reserve(Eigen::Index points) {
  constexpr auto vector = static_cast<Eigen::Index>(probe_vector);
  const Eigen::Index rows = (points + vector - 1) / vector * vector;
  if (places_.rows() < rows) places_.resize(rows, 4);
}

void DeterminantProbe::start(const Points& points) {
  reserve(points.cols());
  begin(points.cols());
  places_.topLeftCorner(points.cols(), 3) = points.transpose();
  fill_last_vector(points.cols());
}

void DeterminantProbe::start_round(const Points& starts, const Eigen::VectorXd& radii,
                                   Wendland kernel) noexcept {
  const Eigen::Index count = ring_size * starts.cols();
  begin(count);
  const double part = kernel == Wendland::c0 ? 0.125 : wendland_steepest_at(kernel);
  for (Eigen::Index i = 0; i < starts.cols(); ++i) {
    auto ring = places_.block<ring_size, 3>(ring_size * i, 0);
    ring.rowwise() = starts.col(i).transpose();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      ring(1 + 2 * axis, axis) += part * radii[i];
      ring(2 + 2 * axis, axis) -= part * radii[i];
    }
  }
  fill_last_vector(count);
}

void DeterminantProbe::begin(Eigen::Index count) noexcept {
  constexpr auto vector = static_cast<Eigen::Index>(probe_vector);
  used_ = (count + vector - 1) / vector * vector;
  assert(used_ <= places_.rows());
  places_.col(3).head(used_).setOnes();
  min_ = 1.0;
}

/// By repeating the last point.
void DeterminantProbe::fill_last_vector(Eigen::Index count) noexcept {
  for (Eigen::Index at = count; at < used_; ++at)
    places_.row(at) = places_.row(count - 1);
}

void DeterminantProbe::advance(const CsrbfField& field) noexcept {
  if (used_ == 0) return;
  min_ = advance_probes(field, {places_.col(0).data(), places_.col(1).data(), places_.col(2).data(),
                                places_.col(3).data(), static_cast<std::size_t>(used_)});
}

} // namespace nendo::deform
