#include "field/block_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace nendo::deform {

namespace {

/// Errors of float sums, as a share of the largest coefficient and of the root of how many supports
/// overlap: measured over the paper's table and a crowded layout, by every instruction set, they
/// are at most 1.6e-7 in a coordinate.
constexpr double float_error = 3e-7;
/// At most so many are taken to overlap; beyond, errors are lost in each other.
constexpr Eigen::Index max_overlapping = 64;
/// Of the model's diagonal. The promise is 1e-5; coordinates in float take 1e-7.
constexpr double max_float_error = 3e-6;

/// Fifth powers of radii between these, and products with them, stay far from float's ends.
constexpr double min_float_radius = 1e-4;
constexpr double max_float_radius = 1e4;
constexpr double max_float = 1e30;

/// Whose library function takes longer than all else that a centre needs.
double power(double base, int exponent) noexcept {
  double product = 1.0;
  for (int n = 0; n < exponent; ++n)
    product *= base;
  return product;
}

float as_float(double value) noexcept {
  return static_cast<float>(std::clamp(value, -max_units, max_units));
}

} // namespace

BlockField::BlockField(const BlockLayout& layout, Eigen::Index entries)
    : origin_(layout.origin()), inverse_unit_(1.0 / layout.unit()),
      tolerance_(max_float_error * layout.diagonal() / layout.unit()) {
  reserve(entries);
}

void BlockField::reserve(Eigen::Index entries) {
  if (x_ != nullptr && entries <= capacity_) return;
  capacity_ = entries;
  const std::size_t size = padded_list_size(static_cast<std::size_t>(entries));
  for (auto* array : {&x_, &y_, &z_, &squared_radius_})
    *array = hwy::AllocateAligned<float>(size);
  names_ = hwy::AllocateAligned<std::uint32_t>(size);
  std::iota(names_.get(), names_.get() + size, 0U);
  entries_.resize(static_cast<std::size_t>(entries));
  precise_entries_.resize(static_cast<std::size_t>(entries));
}

bool BlockField::assign(const CsrbfField& field, Zeros zeros) {
  reserve(field.centres.cols());
  size_ = 0;
  sum_of_coefficients_ = 0.0;
  largest_coefficient_ = 0.0;
  const Eigen::Matrix<double, 3, 3> slope = field.polynomial.rightCols<3>();
  const Eigen::Vector3d constant = (field.polynomial.col(0) + slope * origin_) * inverse_unit_;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    polynomial_[static_cast<std::size_t>(axis)] = {constant[axis], slope(axis, 0), slope(axis, 1),
                                                   slope(axis, 2)};
  const bool usable =
      assign_entries(field, zeros) && field.polynomial.allFinite() && bound(1.0) <= max_units;
  if (!usable) {
    size_ = 0;
    sum_of_coefficients_ = 0.0;
    polynomial_ = {};
  }
  // The padding to whole vectors reaches nothing.
  const auto count = static_cast<std::size_t>(size_);
  for (std::size_t at = count; at < padded_list_size(count); ++at) {
    x_[at] = y_[at] = z_[at] = 0.0F;
    squared_radius_[at] = -1.0F;
  }
  const double overlapping = static_cast<double>(std::min(size_, max_overlapping));
  const double error = float_error * largest_coefficient_ * std::sqrt(overlapping);
  const bool has_polynomial = usable && !field.polynomial.isZero(0.0);
  view_ = {.kernel = field.kernel,
           .keep_volume = field.keep_volume,
           .centres = {x_.get(), y_.get(), z_.get(), squared_radius_.get(), names_.get(), count},
           .entries = entries_.data(),
           .precise_entries = error > tolerance_ || !in_range_ ? precise_entries_.data() : nullptr,
           .polynomial = has_polynomial ? &polynomial_ : nullptr};
  return usable;
}

/// At `at`, all in units.
void BlockField::assign_entry(std::size_t at, const Eigen::Vector3d& centre, double radius,
                              const Eigen::Vector3d& coefficient, const CsrbfField& field) {
  const bool keeps_volume = field.keep_volume > 0.0;
  const double r = std::clamp(radius, 1.0 / max_units, max_units);
  const double inverse = 1.0 / r;
  const double factor =
      keeps_volume ? 1.0 : kernel_factor(field.kernel) * power(inverse, weight_power(field.kernel));
  const Eigen::Vector3d scaled = factor * coefficient;
  const double inner = keeps_volume ? 15.0 * field.keep_volume * inverse * inverse : 1.25 * r;
  precise_entries_[at] = {
      centre[0], centre[1], centre[2], r, inverse, inner, {scaled[0], scaled[1], scaled[2]}};
  entries_[at] = {as_float(centre[0]), as_float(centre[1]), as_float(centre[2]),
                  as_float(r),         as_float(inverse),   as_float(inner)};
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    entries_[at].coefficient[static_cast<std::size_t>(axis)] = as_float(scaled[axis]);
  // Powers of others, and what they are multiplied by, are not numbers that float holds.
  in_range_ = in_range_ && r >= min_float_radius && r <= max_float_radius &&
              scaled.cwiseAbs().maxCoeff() <= max_float;
  x_[at] = entries_[at].x;
  y_[at] = entries_[at].y;
  z_[at] = entries_[at].z;
  squared_radius_[at] = static_cast<float>(
      std::min(radius * radius, static_cast<double>(std::numeric_limits<float>::max())));
}

bool BlockField::assign_entries(const CsrbfField& field, Zeros zeros) {
  in_range_ = true;
  bool finite = true;
  for (Eigen::Index i = 0; i < field.centres.cols(); ++i) {
    if (zeros == Zeros::left_out && field.coefficients.col(i).isZero(0.0)) continue;
    const auto at = static_cast<std::size_t>(size_++);
    const Eigen::Vector3d centre = (field.centres.col(i) - origin_) * inverse_unit_;
    const Eigen::Vector3d coefficient = field.coefficients.col(i) * inverse_unit_;
    const double radius = field.radii[i] * inverse_unit_;
    finite = finite && radius > 0.0 && centre.allFinite() && coefficient.allFinite();
    // The matrices do not turn each coordinate by itself, and their norm is at most 1.
    const double largest =
        field.keep_volume > 0.0 ? coefficient.norm() : coefficient.cwiseAbs().maxCoeff();
    sum_of_coefficients_ += largest;
    largest_coefficient_ = std::max(largest_coefficient_, largest);
    assign_entry(at, centre, radius, coefficient, field);
  }
  return finite;
}

double BlockField::bound(double extent) const noexcept {
  double polynomial = 0.0;
  for (const auto& row : polynomial_)
    polynomial =
        std::max(polynomial, std::abs(row[0]) +
                                 extent * (std::abs(row[1]) + std::abs(row[2]) + std::abs(row[3])));
  return sum_of_coefficients_ + polynomial;
}

} // namespace nendo::deform
