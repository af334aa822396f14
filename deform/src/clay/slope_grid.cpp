#include "clay/slope_grid.hpp"

#include <algorithm>
#include <cmath>

#include "solver/dense.hpp"

namespace nendo::deform {

namespace {

constexpr double cells_a_radius_of_slopes = 2.5; // or fewer, where there would be too many
constexpr double rounding_of_slopes = 1.0001;    // of sums in float

} // namespace

double bound_of_gram(const Eigen::Matrix3d& gram, double radius) noexcept {
  constexpr double derivative_norm_squared = 20.0;                   // of Wendland's C2
  const Eigen::Matrix3d symmetric = 0.5 * (gram + gram.transpose()); // but for rounding it is
  const double largest = std::max(0.0, largest_eigenvalue(symmetric));
  return std::sqrt(derivative_norm_squared * largest) / radius;
}

SlopeGrid::SlopeGrid()
    : sums_(hwy::AllocateAligned<float>(slope_cells * slope_cells * slope_cells)) {
  cells_.sums = sums_.get();
}

void SlopeGrid::begin(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                      double radius) noexcept {
  const Eigen::Array3d extent = (high - low).array() + 2.0 * radius;
  const double size =
      std::max(radius / cells_a_radius_of_slopes, extent.maxCoeff() / (slope_cells - 0.5));
  low_ = low.array() - radius;
  radius_ = radius;
  for (std::size_t axis = 0; axis < 3; ++axis)
    cells_.counts[axis] =
        static_cast<std::size_t>(std::ceil(extent[static_cast<Eigen::Index>(axis)] / size));
  cells_.size = static_cast<float>(size);
  cells_.radius = static_cast<float>(radius);
  std::fill_n(cells_.sums, cells_.counts[2] * slope_cells * slope_cells, 0.0F);
}

void SlopeGrid::add(const Eigen::Vector3d& centre, double coefficient) noexcept {
  const Eigen::Vector3f from_low = (centre - low_).cast<float>();
  add_slopes(cells_, {from_low.x(), from_low.y(), from_low.z()},
             static_cast<float>(coefficient / radius_));
}

double SlopeGrid::lipschitz_bound() const noexcept {
  return rounding_of_slopes * static_cast<double>(steepest_slope(cells_));
}

} // namespace nendo::deform
