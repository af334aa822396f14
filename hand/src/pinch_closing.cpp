#include <nendo/hand/pinch_closing.hpp>

#include <algorithm>
#include <cmath>

#include <nendo/hand/angle_sources.hpp>
#include <nendo/hand/dense.hpp>
#include <nendo/hand/joint_limits.hpp>

#include "fingertip.hpp"

namespace nendo::hand {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr std::size_t max_pinches = 4;
constexpr int max_rows = 3 * max_pinches;
using GapVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_rows, 1>;
using GapMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_rows, max_rows>;
using PadChains = std::array<FingerChain, finger_count>;
using DigitAngles = std::array<FourAngles, finger_count>; // or what they turn by, or variances

// Thumb roll and abduction are taken for more certain than they are, lest they carry all of a
// pinch.
constexpr double thumb_certainty = 0.6;

// The gap of a half-closed pinch: about the error of the joints' angles in a pinch.
constexpr double half_gap_m = 0.008;
constexpr double min_weight = 1e-6;

double smooth_step(double from, double to, double at) noexcept {
  const double part = std::clamp((at - from) / (to - from), 0.0, 1.0);
  return part * part * (3.0 - 2.0 * part);
}

DigitAngles digits_of(const JointAngles& angles) noexcept {
  DigitAngles digits;
  for (std::size_t finger = 0; finger < finger_count; ++finger)
    for (std::size_t k = 0; k < 4; ++k)
      digits[finger][static_cast<Index>(k)] = angles[angle_at(4 * finger + k)];
  return digits;
}

PadChains pad_chains(const HandSkeleton& skeleton) noexcept {
  const auto pad = [&](std::size_t finger) { return FingerChain::to_pad(skeleton, finger); };
  return {pad(0), pad(1), pad(2), pad(3), pad(4)};
}

/// How far a pinch of these pads is closed, 0 to 1.
double weight_of(const Fingertip& thumb, const Fingertip& finger) noexcept {
  const double apart_m = (thumb.position_m - finger.position_m).norm();
  return 1.0 - smooth_step(closed_pinch_m, open_pinch_m, apart_m);
}

class Pinches {
public:
  Pinches(const HandSkeleton& skeleton, const JointAngles& angles) noexcept
      : chains_(pad_chains(skeleton)), from_(digits_of(angles)), arch_rad_(angles.palm_arch_rad) {
    turns_.fill(FourAngles::Zero());
    place_pads();
    for (std::size_t finger = 1; finger < finger_count; ++finger) {
      const double weight = weight_of(pads_[0], pads_[finger]);
      if (weight < min_weight) continue;
      fingers_[count_] = finger;
      slack_m2_[count_++] = half_gap_m * half_gap_m * (1.0 - weight) / weight;
    }
  }

  bool are_there() const noexcept { return count_ > 0; }

  /// Continues to the most likely turns, given that the gaps are closed as far as their weights
  /// say: a Gauss-Newton step, solved in the space of the gaps.
  void step(const DigitAngles& variances) noexcept {
    const Fingertip& thumb = pads_[0];
    const auto size = static_cast<Index>(3 * count_);
    GapVector gaps(size);
    GapMatrix covariance(size, size);
    for (std::size_t n = 0; n < count_; ++n) {
      const Fingertip& pad = pads_[fingers_[n]];
      const auto row = static_cast<Index>(3 * n);
      // As they were without turns, to first order.
      gaps.segment<3>(row) = thumb.position_m - pad.position_m - thumb.by_angle * turns_[0] +
                             pad.by_angle * turns_[fingers_[n]];
      for (std::size_t m = 0; m < count_; ++m)
        covariance.block<3, 3>(row, static_cast<Index>(3 * m)) = spread(thumb, variances[0]);
      covariance.block<3, 3>(row, row) += spread(pad, variances[fingers_[n]]);
      covariance.diagonal().segment<3>(row).array() += slack_m2_[n] + min_slack_m2;
    }
    GapVector pulls = gaps;
    solve_positive_definite(covariance, pulls);
    turns_[0].setZero();
    for (std::size_t n = 0; n < count_; ++n) {
      const std::size_t finger = fingers_[n];
      const Vector3d pull = pulls.segment<3>(static_cast<Index>(3 * n));
      turns_[0] -= variances[0].asDiagonal() * (thumb.by_angle.transpose() * pull);
      turns_[finger] = variances[finger].asDiagonal() * (pads_[finger].by_angle.transpose() * pull);
    }
    place_pads();
  }

  const DigitAngles& turns_rad() const noexcept { return turns_; }

private:
  static constexpr double min_slack_m2 = 1e-10;

  static Eigen::Matrix3d spread(const Fingertip& pad, const FourAngles& variances) noexcept {
    return pad.by_angle * variances.asDiagonal() * pad.by_angle.transpose();
  }
  void place_pads() noexcept {
    for (std::size_t finger = 0; finger < finger_count; ++finger)
      pads_[finger] = chains_[finger].tip(from_[finger] + turns_[finger], arch_rad_);
  }

  PadChains chains_;
  DigitAngles from_, turns_;
  double arch_rad_;
  std::array<Fingertip, finger_count> pads_;
  std::array<std::size_t, max_pinches> fingers_{}; ///< that pinch
  std::array<double, max_pinches> slack_m2_{};     ///< that their gaps are left, a variance
  std::size_t count_ = 0;
};

DigitAngles variances_of(const JointAngles& angles, SensorMask present,
                         SensorMask left_out) noexcept {
  const AngleDeviations deviations = angle_deviations(angles, present, left_out);
  DigitAngles variances;
  for (std::size_t at = 0; at < 4 * finger_count; ++at) {
    const double deviation_rad = (at < 2 ? thumb_certainty : 1.0) * deviations[at];
    variances[at / 4][static_cast<Index>(at % 4)] = deviation_rad * deviation_rad;
  }
  return variances;
}

} // namespace

JointAngles close_pinches(const JointAngles& angles, const HandSkeleton& skeleton,
                          SensorMask present, SensorMask left_out) noexcept {
  Pinches pinches(skeleton, angles);
  if (!pinches.are_there()) return angles;
  const DigitAngles variances = variances_of(angles, present, left_out);
  constexpr int steps = 3; // the third moves pads by less than a tenth of a millimetre
  for (int step = 0; step < steps; ++step)
    pinches.step(variances);
  JointAngles closed = angles;
  for (std::size_t at = 0; at < 4 * finger_count; ++at) {
    double& angle_rad = closed[angle_at(at)];
    const double turned_rad = angle_rad + pinches.turns_rad()[at / 4][static_cast<Index>(at % 4)];
    if (!std::isfinite(turned_rad)) return angles;
    const JointLimit& limit = joint_limits[at];
    angle_rad = std::clamp(turned_rad, std::min(angle_rad, limit.min_rad),
                           std::max(angle_rad, limit.max_rad));
  }
  return closed;
}

} // namespace nendo::hand
