#include "deformer/min_gap.hpp"

#include <algorithm>
#include <cmath>

#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

namespace {
constexpr double never = 2.0;
/// Points nearer than this coincide: squares of it would underflow.
constexpr double min_distance = 1e-150;

/// Of unit vectors: across a way that meets the gap head on, along one that grazes it. With c the
/// cosine of the angle between them, what the wall takes off a way is in proportion to c^2, thus to
/// how far the way's line misses the gap's edge; were the wall across `apart`, it would be c, and
/// begin with the slope of a square root. The pair stays apart by at least 0.96 of its gap.
Eigen::Vector3d wall_normal(const Eigen::Vector3d& apart, const Eigen::Vector3d& motion) noexcept {
  const double c = -apart.dot(motion);
  return (std::sqrt(1.0 + c * c) * (apart + c * motion) - c * c * motion).normalized();
}

} // namespace

void MinGap::reserve(Eigen::Index points) {
  starts_.resize(3, points);
  radii_.resize(points);
  // Thousands of points, in a batch, have too many pairs for that.
  const Eigen::Index most = std::min(points, CsrbfSolver::lean_size);
  walls_.reserve(static_cast<std::size_t>(most * (most - 1) / 2));
}

void MinGap::begin(const Points& starts, const Eigen::VectorXd& radii) {
  starts_ = starts;
  radii_ = radii;
  walls_.clear();
}

void MinGap::release(const Points& wanted) noexcept {
  std::erase_if(walls_, [&](const HeldPair& wall) {
    return wall.normal.dot(wanted.col(wall.first) - wanted.col(wall.second)) >= wall.gap;
  });
}

/// Hildreth's method: Gauss-Seidel on the pushes, none of which may pull. It converges to the
/// projection; where it is stopped sooner, a pair may come a little nearer than its gap.
void MinGap::project(const Points& wanted, Points& allowed) noexcept {
  constexpr int max_sweeps = 64;
  constexpr double tolerance = 1e-12; // of the gap
  allowed = wanted;
  for (HeldPair& wall : walls_)
    wall.push = 0.0;
  bool settled = walls_.empty();
  for (int sweep = 0; sweep < max_sweeps && !settled; ++sweep) {
    settled = true;
    for (HeldPair& wall : walls_) {
      const double apart = wall.normal.dot(allowed.col(wall.first) - allowed.col(wall.second));
      const double change = std::max(-wall.push, 0.5 * (wall.gap - apart));
      wall.push += change;
      allowed.col(wall.first) += change * wall.normal;
      allowed.col(wall.second) -= change * wall.normal;
      settled = settled && std::abs(change) <= tolerance * wall.gap;
    }
  }
}

double MinGap::free_part(const Points& from, const Points& to) const noexcept {
  double part = 1.0;
  for (Eigen::Index second = 1; second < from.cols(); ++second)
    for (Eigen::Index first = 0; first < second; ++first)
      part = std::min(part, contact(first, second, from, to));
  return part;
}

bool MinGap::hold(const Points& from, const Points& to, double part) {
  constexpr double rounding = 1e-9;
  const std::size_t before = walls_.size();
  for (Eigen::Index second = 1; second < from.cols(); ++second)
    for (Eigen::Index first = 0; first < second; ++first) {
      const double at = contact(first, second, from, to);
      if (!(at <= part + rounding)) continue;
      const Eigen::Vector3d apart =
          (1.0 - at) * (from.col(first) - from.col(second)) + at * (to.col(first) - to.col(second));
      const Eigen::Vector3d motion =
          to.col(first) - from.col(first) - (to.col(second) - from.col(second));
      if (!(apart.norm() > min_distance)) continue;
      const Eigen::Vector3d normal = wall_normal(apart.normalized(), motion.normalized());
      walls_.push_back({first, second, normal, normal.dot(apart)});
    }
  return walls_.size() > before;
}

bool MinGap::has_wall(Eigen::Index first, Eigen::Index second) const noexcept {
  return std::any_of(walls_.begin(), walls_.end(), [&](const HeldPair& wall) {
    return wall.first == first && wall.second == second;
  });
}

double MinGap::gap_of(Eigen::Index first, Eigen::Index second) const noexcept {
  const double at_first = (starts_.col(first) - starts_.col(second)).norm();
  const double gap = std::min(fraction_ * std::min(radii_[first], radii_[second]), 0.5 * at_first);
  return gap > 2.0 * min_distance ? gap : 0.0;
}

/// When the pair comes to its gap, or never. Written with the nearest approach, so that no square
/// of a square overflows.
double MinGap::contact(Eigen::Index first, Eigen::Index second, const Points& from,
                       const Points& to) const noexcept {
  const Eigen::Vector3d apart = from.col(first) - from.col(second);
  const Eigen::Vector3d motion = to.col(first) - to.col(second) - apart;
  const double approach = apart.dot(motion);
  if (!(approach < 0.0)) return never;
  const double speed_squared = motion.squaredNorm();
  const double nearest_at = -approach / speed_squared;
  const double nearest_squared = (apart + nearest_at * motion).squaredNorm();
  const double gap = gap_of(first, second);
  if (!(nearest_squared < gap * gap) || has_wall(first, second)) return never;
  const double at = nearest_at - std::sqrt((gap * gap - nearest_squared) / speed_squared);
  return at < 1.0 ? std::max(at, 0.0) : never;
}

} // namespace nendo::deform
