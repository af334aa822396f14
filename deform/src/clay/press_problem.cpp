#include "clay/press_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/decompositions.hpp"

namespace nendo::deform {

namespace {

constexpr double cells_per_radius_of_slopes = 2.5; // or fewer, where there would be too many
constexpr double rounding_of_slopes = 1.0001;      // of sums in float

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
      std::max(radius / cells_per_radius_of_slopes, extent.maxCoeff() / (slope_cells - 0.5));
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

using Eigen::Vector3d;

namespace {

// It makes the matrix definite where places coincide, and yields by a billionth.
constexpr double ridge = 1e-9;
// A tangent's, because places of one part move together and need no exact fit.
constexpr double tangent_ridge = 1e-3;
// Of the largest depth: below this, nothing moves any more.
constexpr double enough = 1e-5;
constexpr double enough_way = 1e-3; // of the largest way
constexpr double sticks_again = 0.8;
// Beyond all radii. Padding is there; its square is finite.
constexpr double far_away = 1e60;

std::size_t padded(std::size_t count) noexcept {
  return (count + press_lanes - 1) / press_lanes * press_lanes;
}

} // namespace

PressProblem::PressProblem(std::size_t most) : max_(padded(most)) {
  for (auto* matrix : {&psi_, &a_})
    *matrix = hwy::AllocateAligned<double>(max_ * max_);
  for (auto* numbers : {&p_, &l_, &w_})
    *numbers = hwy::AllocateAligned<double>(max_);
  for (auto* three : {&places_, &normals_, &t_, &left_})
    for (auto& numbers : *three)
      numbers = hwy::AllocateAligned<double>(max_);
}

PressArrays PressProblem::arrays() const noexcept {
  return {count_,           stride_,
          places_[0].get(), places_[1].get(),
          places_[2].get(), {normals_[0].get(), normals_[1].get(), normals_[2].get()},
          psi_.get(),       a_.get()};
}

void PressProblem::assign(std::span<const ContactPoint> points, double radius) noexcept {
  radius_ = radius;
  count_ = points.size();
  stride_ = padded(count_);
  for (std::size_t i = 0; i < stride_; ++i) {
    const bool is_padding = i >= count_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<Eigen::Index>(axis);
      places_[axis][i] = is_padding ? far_away : points[i].at[at];
      normals_[axis][i] = is_padding ? 0.0 : points[i].normal[at];
      t_[axis][i] = left_[axis][i] = 0.0;
    }
    p_[i] = is_padding ? 0.0 : points[i].depth;
    l_[i] = 0.0;
  }
  fill_press_matrices(arrays(), radius, ridge);
}

void PressProblem::solve_pressure(double extra) noexcept {
  double deepest = 0.0;
  for (std::size_t i = 0; i < stride_; ++i) {
    w_[i] = i < count_ ? -p_[i] - extra : 0.0;
    deepest = std::max(deepest, -w_[i]);
  }
  sweep_pressure(arrays(), l_.get(), w_.get(), enough * deepest, max_sweeps);
}

/// Returns whether anything moved.
bool PressProblem::sweep_friction(std::span<const Friction> frictions, double coefficient,
                                  double least) noexcept {
  bool is_moved = false;
  for (std::size_t i = 0; i < count_; ++i) {
    const Friction& friction = frictions[i];
    const double limit = coefficient * (l_[i] + friction.load);
    if (limit <= 0.0) continue;
    const Vector3d normal = at(normals_, i);
    const Vector3d before = at(t_, i);
    const Vector3d left = at(left_, i) - tangent_ridge * before;
    Vector3d after = before + (left - left.dot(normal) * normal) / (1.0 + tangent_ridge);
    const double force = after.norm();
    std::uint8_t& slips = *friction.slips;
    slips = force > limit * (slips != 0 ? sticks_again : 1.0) ? 1 : 0;
    const double most = limit * (slips != 0 ? sticks_again : 1.0);
    if (force > most) after *= most / force;
    const Vector3d change = after - before;
    if (change.squaredNorm() <= least * least) continue;
    for (std::size_t axis = 0; axis < 3; ++axis)
      t_[axis][i] = after[static_cast<Eigen::Index>(axis)];
    add_row(arrays(), psi_row(i), {-change.x(), -change.y(), -change.z()},
            {left_[0].get(), left_[1].get(), left_[2].get()});
    is_moved = true;
  }
  return is_moved;
}

void PressProblem::solve_friction(std::span<const Friction> frictions,
                                  double coefficient) noexcept {
  for (std::size_t i = 0; i < count_; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      left_[axis][i] = frictions[i].way[static_cast<Eigen::Index>(axis)];
  for (std::size_t i = 0; i < count_; ++i) // what the pressing field does already
    if (l_[i] > 0.0)
      add_row(arrays(), psi_row(i),
              {-l_[i] * normals_[0][i], -l_[i] * normals_[1][i], -l_[i] * normals_[2][i]},
              {left_[0].get(), left_[1].get(), left_[2].get()});
  double farthest = 0.0;
  for (std::size_t i = 0; i < count_; ++i)
    farthest = std::max(farthest, frictions[i].way.norm());
  for (int sweep = 0; sweep < max_sweeps; ++sweep)
    if (!sweep_friction(frictions, coefficient, enough_way * farthest)) break;
}

Vector3d PressProblem::coefficient(std::size_t i) const noexcept {
  return {l_[i] * normals_[0][i] + t_[0][i], l_[i] * normals_[1][i] + t_[1][i],
          l_[i] * normals_[2][i] + t_[2][i]};
}

/// The sums of psi_ij c_j are stored in left_.
double PressProblem::lipschitz_bound(double enough) noexcept {
  for (auto& numbers : left_)
    std::fill_n(numbers.get(), stride_, 0.0);
  for (std::size_t i = 0; i < count_; ++i)
    if (const Vector3d one = coefficient(i); !one.isZero(0.0))
      add_row(arrays(), psi_row(i), {one.x(), one.y(), one.z()},
              {left_[0].get(), left_[1].get(), left_[2].get()});
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < count_; ++i)
    gram += coefficient(i) * Eigen::RowVector3d(left_[0][i], left_[1][i], left_[2][i]);
  const double bound = bound_of_gram(gram, radius_);
  return bound <= enough ? bound : std::min(bound, bound_of_slopes());
}

double PressProblem::bound_of_slopes() noexcept {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Eigen::Array3d low = Eigen::Array3d::Constant(infinite), high = -low;
  for (std::size_t i = 0; i < count_; ++i) {
    low = low.min(at(places_, i).array());
    high = high.max(at(places_, i).array());
  }
  slopes_.begin(low, high, radius_);
  for (std::size_t i = 0; i < count_; ++i)
    if (const double length = coefficient(i).norm(); length > 0.0)
      slopes_.add(at(places_, i), length);
  return slopes_.lipschitz_bound();
}

} // namespace nendo::deform
