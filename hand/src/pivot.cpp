#include "pivot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/LU>

#include <nendo/hand/dense.hpp>

namespace nendo::hand {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The sums of some poses that their least squares needs. With the mean turn A and the mean
/// position b, still = A centre + b, and what is left are the normal equations of the centre.
struct PivotSums {
  double count = 0.0;
  Matrix3d turn = Matrix3d::Zero();
  Vector3d position = Vector3d::Zero();
  Vector3d product = Vector3d::Zero(); ///< sum of R^T p
  Matrix3d noise = Matrix3d::Zero();   ///< what noise of the turns adds to normal()

  void add(const StationPose& pose) {
    count += 1.0;
    turn += pose.turn;
    position += pose.position_m;
    product.noalias() += pose.turn.transpose() * pose.position_m;
  }
  Matrix3d mean_turn() const { return turn / count; }
  /// The mean of (R - A)^T (R - A), without noise.
  Matrix3d normal() const {
    return Matrix3d::Identity() - mean_turn().transpose() * mean_turn() - noise;
  }
};

struct Pivot {
  Vector3d centre_m;
  Vector3d still_m;

  Vector3d residual(const StationPose& pose) const {
    return pose.turn * centre_m + pose.position_m - still_m;
  }
};

std::optional<Pivot> solve_pivot(const PivotSums& sums) {
  constexpr double min_determinant = 1e-12; // of turns within a fraction of a degree
  const Matrix3d normal = sums.normal();
  if (!(normal.determinant() > min_determinant)) return std::nullopt;
  const Matrix3d turn = sums.mean_turn();
  const Vector3d position = sums.position / sums.count;
  Pivot pivot;
  pivot.centre_m = -normal.inverse() * (sums.product / sums.count - turn.transpose() * position);
  pivot.still_m = turn * pivot.centre_m + position;
  return pivot;
}

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double median_distance_m(const Pivot& pivot, const std::vector<StationPose>& poses,
                         std::size_t stride) {
  std::vector<double> squares;
  for (std::size_t at = 0; at < poses.size(); at += stride)
    squares.push_back(pivot.residual(poses[at]).squaredNorm());
  return std::sqrt(median_of(squares));
}

/// The least median of squares: some few poses determine a point, and the point is taken that half
/// of all poses are nearest to. Flipped and torn poses, even many, do not move it.
std::optional<Pivot> find_pivot_start(const std::vector<StationPose>& poses) {
  constexpr int trials = 300;
  constexpr int poses_each = 6;
  constexpr std::size_t judges = 150;
  const std::size_t stride = std::max<std::size_t>(1, poses.size() / judges);
  std::mt19937 random(1);
  std::optional<Pivot> best;
  double best_m = std::numeric_limits<double>::infinity();
  for (int trial = 0; trial < trials; ++trial) {
    PivotSums sums;
    for (int k = 0; k < poses_each; ++k)
      sums.add(poses[random() % poses.size()]);
    const auto pivot = solve_pivot(sums);
    if (!pivot) continue;
    const double distance_m = median_distance_m(*pivot, poses, stride);
    if (!(distance_m < best_m)) continue;
    best_m = distance_m;
    best = pivot;
  }
  return best;
}

/// Returns the mean of E^T E, where E is the noise of a turn, from second differences in time,
/// which a smooth motion hardly has. Noise makes the turns look larger than they are, and the
/// centre would come out too near: at 2.5 degrees of noise by some millimetres.
Matrix3d turn_noise(const std::vector<StationPose>& poses) {
  constexpr double max_step_s = 0.05;
  constexpr double squares = 1.0 + 4.0 + 1.0; // of the factors in a second difference
  Matrix3d sum = Matrix3d::Zero();
  double count = 0.0;
  for (std::size_t at = 2; at < poses.size(); ++at) {
    if (poses[at].time_s - poses[at - 2].time_s > 2.0 * max_step_s) continue;
    const Matrix3d change = poses[at].turn - 2.0 * poses[at - 1].turn + poses[at - 2].turn;
    sum.noalias() += change.transpose() * change;
    count += squares;
  }
  return count > 0.0 ? Matrix3d(sum / count) : Matrix3d(Matrix3d::Zero());
}

PivotSums sums_of(const std::vector<StationPose>& poses) {
  PivotSums sums;
  for (const StationPose& pose : poses)
    sums.add(pose);
  sums.noise = turn_noise(poses);
  return sums;
}

/// Least squares over the poses that are near, again and again. Returns those of the last round.
std::vector<StationPose> refine_pivot(Pivot& pivot, const std::vector<StationPose>& poses) {
  constexpr int rounds = 5;
  constexpr double median_deviations = 1.538; // the median length of a vector of three deviations
  constexpr double max_deviations = 5.0;
  constexpr double min_deviation_m = 0.2e-3;
  std::vector<StationPose> used;
  for (int round = 0; round < rounds; ++round) {
    const double deviation_m =
        std::max(median_distance_m(pivot, poses, 1) / median_deviations, min_deviation_m);
    used.clear();
    for (const StationPose& pose : poses)
      if (pivot.residual(pose).norm() <= max_deviations * deviation_m) used.push_back(pose);
    const auto solved = solve_pivot(sums_of(used));
    if (!solved) break;
    pivot = *solved;
  }
  return used;
}

/// The standard deviation of the centre. Errors of poses within half a second of each other are
/// not independent, since skin moves slowly, so each half second counts as one.
double centre_deviation_m(const Pivot& pivot, const std::vector<StationPose>& used,
                          const PivotSums& sums) {
  constexpr double block_s = 0.5;
  const Matrix3d mean = sums.mean_turn();
  Matrix3d scatter = Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();
  int blocks = 0;
  double end_s = used.front().time_s + block_s;
  const auto close_block = [&] {
    scatter.noalias() += gradient * gradient.transpose();
    gradient.setZero();
    ++blocks;
  };
  for (const StationPose& pose : used) {
    if (pose.time_s >= end_s) {
      close_block();
      end_s = pose.time_s + block_s;
    }
    gradient.noalias() += (pose.turn - mean).transpose() * pivot.residual(pose);
  }
  close_block();
  const Matrix3d inverse = sums.normal().inverse() / sums.count;
  const double lost = blocks > 2 ? blocks / (blocks - 2.0) : 1.0; // by fitting six unknowns
  return std::sqrt(lost * (inverse * scatter * inverse).trace());
}

double drift_of(const Pivot& pivot, const std::vector<StationPose>& poses) {
  constexpr double window_s = 2.0;
  constexpr std::size_t min_poses = 10;
  double drift = 0.0;
  for (std::size_t first = 0; first < poses.size();) {
    std::array<std::vector<double>, 3> offsets;
    const double end_s = poses[first].time_s + window_s;
    for (; first < poses.size() && poses[first].time_s < end_s; ++first) {
      const Vector3d residual = pivot.residual(poses[first]);
      for (int axis = 0; axis < 3; ++axis)
        offsets[static_cast<std::size_t>(axis)].push_back(residual[axis]);
    }
    if (offsets[0].size() < min_poses) continue;
    const Vector3d middle(median_of(offsets[0]), median_of(offsets[1]), median_of(offsets[2]));
    drift = std::max(drift, middle.norm());
  }
  return drift;
}

} // namespace

std::optional<PivotFit> fit_pivot(const std::vector<StationPose>& poses) {
  if (poses.empty()) return std::nullopt;
  auto pivot = find_pivot_start(poses);
  if (!pivot) return std::nullopt;
  PivotFit fit;
  fit.used = refine_pivot(*pivot, poses);
  const PivotSums sums = sums_of(fit.used);
  if (!solve_pivot(sums)) return std::nullopt;
  double square_m2 = 0.0;
  for (const StationPose& pose : fit.used)
    square_m2 += pivot->residual(pose).squaredNorm();
  fit.centre_m = pivot->centre_m;
  fit.still_m = pivot->still_m;
  fit.residual_m = std::sqrt(square_m2 / sums.count);
  const Eigen::VectorXd squares = eigenvalues_of_symmetric(sums.normal());
  fit.smallest_singular_value = std::sqrt(std::max(squares[0], 0.0));
  fit.largest_singular_value = std::sqrt(squares[2]);
  fit.centre_deviation_m = centre_deviation_m(*pivot, fit.used, sums);
  fit.drift_m = drift_of(*pivot, poses);
  return fit;
}

} // namespace nendo::hand
