#pragma once
// The filter between a tracker's poses and the wrist: the 1-euro filter (joint_filter.hpp) for a
// position and a turn. Not each coordinate has its own cutoff, but the whole position and the whole
// turn, by their speeds, so that the axes that a tracker happens to have do not matter. The turn is
// filtered on the sphere of the quaternions, towards the new one by the shorter way.

#include <Eigen/Geometry>

#include <nendo/driver/pose_sample.hpp>
#include <nendo/hand/joint_filter.hpp>

namespace nendo::hand {

/// The cutoff of the position is min_cutoff_hz + beta_hz_per_m_s |velocity|, and the turn's has a
/// beta of its own. The defaults were chosen with a FASTRAK's noise, 0.8 mm and 0.15 degrees (root
/// mean square of an axis), at 30 to 240 Hz: at rest, 0.24 mm of it remain at 30 Hz and 0.10 mm at
/// 240 Hz, and movements of 5 to 40 cm that reach 0.5 m/s are delayed by 12 to 20 ms. A constant
/// cutoff with 0.25 mm at 30 Hz would delay them by 154 ms. The speed of noise alone raises the
/// cutoff at rest, the more the higher the derivative's cutoff is. With the authors' 1 Hz for that,
/// the filter follows noise for longer after each stroke.
struct PoseFilterOptions {
  FilterKind kind = FilterKind::off;
  double min_cutoff_hz = 0.4;
  double beta_hz_per_m_s = 35.0;
  double beta_hz_per_rad_s = 6.5; ///< at a fingertip, 0.19 m from the wrist, as beta_hz_per_m_s
  double derivative_cutoff_hz = 2.0;

  friend bool operator==(const PoseFilterOptions&, const PoseFilterOptions&) = default;
};

/// The filter's current delays, in seconds.
struct PoseLatency {
  double position_s = 0.0;
  double turn_s = 0.0;
};

class NENDO_API PoseFilter {
public:
  /// The filter restarts after a longer pause, or if time steps back by more.
  static constexpr double longest_interval_s = JointFilter::longest_interval_s;

  /// Limits the cutoffs to 0.001 to 100000 Hz and the betas to 0 to 100000; NaN becomes the lower
  /// limit.
  explicit PoseFilter(const PoseFilterOptions& options = {}) noexcept;

  /// Returns the sample with the filtered pose. The numbers must be finite and the quaternion of
  /// unit length, as PoseGate passes them. `measured` is the time that counts. The first sample,
  /// and the first after a pause, pass unchanged; with FilterKind::off all do. If time has not
  /// advanced, the filtered pose stays, and the change counts as movement. A quaternion and its
  /// negative are the same turn. Wait-free, no allocation.
  PoseSample pass(const PoseSample& sample) noexcept;

  /// Returns the delays at the present cutoffs: 1 / (2 pi cutoff), as JointFilter::latency_s().
  /// They are 0 if the filter is off, and before the first sample.
  PoseLatency latency() const noexcept;

  const PoseFilterOptions& options() const noexcept { return options_; }

private:
  void restart(const PoseSample& sample) noexcept;
  void step_position(const Eigen::Vector3d& position_m, double interval_s) noexcept;
  void step_turn(const Eigen::Quaterniond& turn, double interval_s) noexcept;

  PoseFilterOptions options_;
  Eigen::Vector3d last_position_m_ = Eigen::Vector3d::Zero(); ///< the last input
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();      ///< the last output
  Eigen::Vector3d velocity_m_s_ = Eigen::Vector3d::Zero();    ///< filtered
  Eigen::Quaterniond last_turn_ = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d turn_velocity_rad_s_ = Eigen::Vector3d::Zero(); ///< in the tracker's axes
  HostTime last_time_{};
  bool begun_ = false;
};

} // namespace nendo::hand
