#include "turn_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include <nendo/hand/dense.hpp>

namespace nendo::hand {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double grid_s = 1e-3;
constexpr int half_smoothing = 100; // steps of the grid: velocities are means over 200 ms
constexpr double smoothing_s = 2.0 * half_smoothing * grid_s;
constexpr int max_shift = static_cast<int>(max_late_s / grid_s);
constexpr int sum_step = 5; // steps of the grid between the products that are summed
constexpr double min_overlap_s = 3.0;
constexpr double min_velocity_rad_s = 0.1; // root mean square; circles have ten times as much

// How far the hand may be turned from the horizontal. For an even circle, a hand that is rolled and
// a tracker that is late look the same. So the hand counts as flat unless the motion contradicts.
constexpr double flat_rad = 1e-4;
constexpr double nearly_flat_rad = 3.0 * std::numbers::pi / 180.0; // as a person lays it
/// By how much the logarithm of the likelihood must be better without a flat hand. White noise
/// alone gives 6 in one of 400 recordings; the steps of 8-bit counts give more.
constexpr double contradiction = 12.0;

/// Turning velocities in fixed axes, on a grid that begins at `first_s`.
struct Velocities {
  double first_s = 0.0;
  std::vector<Vector3d> rad_s;

  double end_s() const { return first_s + grid_s * static_cast<double>(rad_s.size()); }
  const Vector3d& at(double time_s) const {
    return rad_s[static_cast<std::size_t>(std::lround((time_s - first_s) / grid_s))];
  }
};

/// Adds up the small turns between samples, which lie on a straight line between them.
Velocities velocities_of(const std::vector<TimedTurn>& turns, double origin_s) {
  Velocities velocities;
  if (turns.size() < 2) return velocities;
  std::vector<Vector3d> turned; // the sums on the grid
  const double begin = std::ceil((turns.front().time_s - origin_s) / grid_s);
  Vector3d sum = Vector3d::Zero();
  for (std::size_t at = 1; at < turns.size(); ++at) {
    const TimedTurn& from = turns[at - 1];
    const TimedTurn& to = turns[at];
    const Eigen::AngleAxisd step(Matrix3d(to.turn * from.turn.transpose()));
    const Vector3d change = step.angle() * step.axis();
    for (;;) {
      const double time_s = origin_s + grid_s * (begin + static_cast<double>(turned.size()));
      if (time_s > to.time_s) break;
      turned.push_back(sum + (time_s - from.time_s) / (to.time_s - from.time_s) * change);
    }
    sum += change;
  }
  constexpr std::size_t width = std::size_t{2} * half_smoothing;
  velocities.first_s = origin_s + grid_s * (begin + half_smoothing);
  for (std::size_t at = width; at < turned.size(); ++at)
    velocities.rad_s.push_back((turned[at] - turned[at - width]) / (grid_s * width));
  return velocities;
}

/// The velocities of the wrist over the seconds in which the tracker's are known for all shifts.
struct Comparison {
  const Velocities& tracker;
  const Velocities& wrist;
  double begin_s = 0.0;
  std::size_t count = 0;

  /// The sum of products, divided by the lengths of both, so that its trace is a correlation.
  Matrix3d correlations(int shift) const {
    Matrix3d sum = Matrix3d::Zero();
    double tracker_square = 0.0, wrist_square = 0.0;
    for (std::size_t at = 0; at < count; ++at) {
      const double time_s = begin_s + grid_s * static_cast<double>(sum_step * at);
      const Vector3d& by_tracker = tracker.at(time_s + grid_s * shift);
      const Vector3d& by_wrist = wrist.at(time_s);
      sum.noalias() += by_tracker * by_wrist.transpose();
      tracker_square += by_tracker.squaredNorm();
      wrist_square += by_wrist.squaredNorm();
    }
    const double least = min_velocity_rad_s * min_velocity_rad_s * static_cast<double>(count);
    if (tracker_square < least || wrist_square < least) return Matrix3d::Zero();
    return sum / std::sqrt(tracker_square * wrist_square);
  }
  double duration_s() const { return grid_s * sum_step * static_cast<double>(count); }
};

/// For each shift, how likely it is with the best turn of the hand: the logarithm, up to a
/// constant. How flat the hand lies is a pair of vectors more, the vertical in both frames.
struct Likelihoods {
  const std::vector<Matrix3d>& correlations; ///< from -max_shift to max_shift
  double weight = 0.0;                       ///< weight of a correlation of 1
  double tilt_rad = flat_rad;                ///< standard deviation of the hand's tilt

  Matrix3d turn(int shift) const { return nearest_rotation(evidence(shift)); }
  double at(int shift) const {
    return turn(shift).cwiseProduct(evidence(shift)).sum() - vertical_weight();
  }
  double correlation(int shift) const { return turn(shift).cwiseProduct(of(shift)).sum(); }
  int best_shift() const {
    int best = -max_shift;
    double most = -std::numeric_limits<double>::infinity();
    for (int shift = -max_shift; shift <= max_shift; ++shift) {
      const double now = at(shift);
      if (now <= most) continue;
      most = now;
      best = shift;
    }
    return best;
  }
  /// Returns the second derivative, per square of a step of the grid.
  double bend(int shift) const {
    return (at(shift - reach) - 2.0 * at(shift) + at(shift + reach)) / (reach * reach);
  }
  /// Returns the slope per step of the grid.
  double slope(int shift) const { return (at(shift + reach) - at(shift - reach)) / (2.0 * reach); }

  /// Steps of the grid to either side that show the peak's position. Within some milliseconds of
  /// the peak, the product of both devices' noise moves it by far more than the noise of one does.
  static constexpr int reach = 40;

private:
  double vertical_weight() const { return 1.0 / (tilt_rad * tilt_rad); }
  const Matrix3d& of(int shift) const {
    return correlations[static_cast<std::size_t>(std::ptrdiff_t{shift} + max_shift)];
  }
  Matrix3d evidence(int shift) const {
    Matrix3d sum = weight * of(shift);
    sum(1, 1) += vertical_weight();
    return sum;
  }
};

/// The weight of correlations that have this peak. What is left unexplained is noise in three axes,
/// which is independent after the time of smoothing.
double weight_of(double correlation, double duration_s) {
  constexpr double min_unexplained = 1e-4;
  const double count = 3.0 * duration_s / smoothing_s;
  return count / std::max(1.0 - correlation * correlation, min_unexplained);
}

/// Takes the hand as flat, or, if that contradicts the motion, as nearly flat. Notes the peak's
/// position by a parabola.
TurnMatch match_of(const std::vector<Matrix3d>& correlations, double duration_s) {
  Likelihoods flat{correlations, weight_of(0.9, duration_s)};
  Likelihoods nearly = flat;
  nearly.tilt_rad = nearly_flat_rad;
  flat.weight = nearly.weight = weight_of(nearly.correlation(nearly.best_shift()), duration_s);
  const int flat_shift = flat.best_shift(), nearly_shift = nearly.best_shift();
  const bool is_flat = nearly.at(nearly_shift) - flat.at(flat_shift) < contradiction;
  const Likelihoods& best = is_flat ? flat : nearly;
  const int shift = is_flat ? flat_shift : nearly_shift;
  TurnMatch match;
  match.correlation = best.correlation(shift);
  const Matrix3d turn = best.turn(shift);
  match.heading_rad = std::atan2(turn(0, 2), turn(2, 2));
  match.late_s = grid_s * shift;
  match.late_deviation_s = max_late_s;
  if (std::abs(shift) == max_shift) return match; // the peak may lie beyond
  constexpr int max_middle = max_shift - Likelihoods::reach;
  const int middle = std::clamp(shift, -max_middle, max_middle);
  if (const double bend = best.bend(middle); bend < 0.0) {
    match.late_s = grid_s * (middle - best.slope(middle) / bend);
    match.late_deviation_s = std::min(grid_s / std::sqrt(-bend), max_late_s);
  }
  return match;
}

} // namespace

std::optional<TurnMatch> match_turns(const std::vector<TimedTurn>& by_tracker,
                                     const std::vector<TimedTurn>& by_wrist) {
  if (by_tracker.empty() || by_wrist.empty()) return std::nullopt;
  const double origin_s = by_wrist.front().time_s;
  const Velocities tracker = velocities_of(by_tracker, origin_s);
  const Velocities wrist = velocities_of(by_wrist, origin_s);
  const double margin_s = max_late_s + grid_s;
  const double begin_s = std::max(wrist.first_s, tracker.first_s + margin_s);
  const double end_s = std::min(wrist.end_s(), tracker.end_s() - margin_s) - grid_s;
  if (!(end_s - begin_s >= min_overlap_s)) return std::nullopt;
  const Comparison comparison{tracker, wrist, begin_s,
                              static_cast<std::size_t>((end_s - begin_s) / (grid_s * sum_step))};
  std::vector<Matrix3d> correlations;
  correlations.reserve(2 * max_shift + 1);
  for (int shift = -max_shift; shift <= max_shift; ++shift)
    correlations.push_back(comparison.correlations(shift));
  if (correlations[max_shift].isZero()) return TurnMatch{0.0, max_late_s, 0.0, 0.0};
  return match_of(correlations, comparison.duration_s());
}

} // namespace nendo::hand
