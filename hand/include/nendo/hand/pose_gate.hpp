#pragma once
// The pose gate: refuses poses of a tracker's station that no hand can have caused, and mirrors
// back the poses of the wrong hemisphere. Few trackers send a checksum, so a damaged byte leaves a
// record well formed; and a magnetic field is the same at p and at -p, so a receiver that crosses
// to the other half of the space is reported at -p.

#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

#include <nendo/driver/pose_sample.hpp>

namespace nendo::hand {

struct PoseGateOptions {
  double max_distance_m = 3.0; ///< from the tracker's origin

  friend bool operator==(const PoseGateOptions&, const PoseGateOptions&) = default;
};

/// Uses no clock and no I/O; wait-free, no allocation. The caller reports the counts.
class NENDO_API PoseGate {
public:
  /// A quaternion's length may differ from 1 by this much.
  static constexpr double max_length_error = 0.002;
  /// A position may differ from the prediction by noise_m + max_acceleration_m_s2 / 2 dt^2, where
  /// dt is the time since the last good pose, or between the last two if that was longer. So that
  /// no good pose is refused after damage within that, it may also differ by noise_m from where the
  /// poses before the last one lead.
  static constexpr double noise_m = 0.008;
  static constexpr double max_acceleration_m_s2 = 30.0;
  /// Where a record of a fast stream is missing, so long a dt would let damage pass. A pose farther
  /// than this from the prediction is then refused once: the next one says what is true.
  static constexpr double certain_m = 0.012;
  /// Limits the position instead, while there is no prediction: after the first pose, and after a
  /// pause. Fast strokes of a hand reach 5 m/s.
  static constexpr double max_speed_m_s = 5.0;
  /// The turn may differ from the last one by turn_noise_rad + max_turn_speed_rad_s dt. Flicks of a
  /// wrist reach 25 rad/s. A flipped sign in a quaternion keeps its length, but turns the hand: a
  /// sudden turn that vanishes with the opposite sign of one component is refused.
  static constexpr double turn_noise_rad = 0.1;
  static constexpr double max_turn_speed_rad_s = 30.0;
  /// The sample that follows so many unexpected ones passes, and the gate restarts from it; but not
  /// with the letters j and k, by which a FASTRAK says that it cannot measure the field.
  static constexpr int max_refusals_in_a_row = 5;
  /// The gate also restarts after a longer pause, because the hand can then be anywhere: half of
  /// 30 m/s^2 for 0.5 s are farther than a tracker reaches; and if time steps back by more.
  static constexpr double longest_pause_s = 0.5;

  explicit PoseGate(const PoseGateOptions& options = {}) noexcept : options_(options) {}

  /// Takes the next sample of one station, in order of time, and returns the sample to use instead
  /// of it: in the hemisphere of the last one, and its quaternion normalised. Returns nothing if it
  /// is refused: numbers that are not finite or out of range always are, and poses that are not as
  /// expected up to max_refusals_in_a_row. `measured` is the time that counts. The hemisphere is
  /// that of the first sample, and of the first after longest_pause_s.
  std::optional<PoseSample> pass(const PoseSample& sample) noexcept;

  /// Returns whether the gate restarted from the last sample that passed, so that it may be far
  /// from the previous one. The first sample counts.
  bool has_restarted() const noexcept { return has_restarted_; }
  std::uint64_t refused() const noexcept { return refused_; }
  /// Returns the number of samples that were mirrored back. The receiver crossed the transmitter's
  /// hemisphere if it is not 0.
  std::uint64_t flips() const noexcept { return flips_; }

private:
  struct Point {
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    HostTime time{};
  };
  bool is_flip(const Eigen::Vector3d& position_m, double interval_s) const noexcept;
  double deviation_m(const Eigen::Vector3d& position_m, double interval_s) const noexcept;
  bool is_expected(const Eigen::Vector3d& position_m, double interval_s) const noexcept;
  bool is_doubtful(const Eigen::Vector3d& position_m, double interval_s) const noexcept;
  bool is_expected(const Eigen::Quaterniond& turn, double interval_s) const noexcept;
  Eigen::Vector3d predicted_m(double interval_s) const noexcept;
  void restart(const Point& point, const Eigen::Quaterniond& turn) noexcept;
  void advance(const Point& point, const Eigen::Quaterniond& turn, double interval_s) noexcept;

  PoseGateOptions options_;
  Point last_;  ///< the last good pose
  Point newer_; ///< good poses that are far enough apart in time for a velocity,
  Point older_; ///< which is that from `older_` to `last_`
  Eigen::Quaterniond last_turn_ = Eigen::Quaterniond::Identity();
  double last_turn_speed_rad_s_ = 0.0;               ///< between the last two good poses
  Eigen::Vector3d step_m_ = Eigen::Vector3d::Zero(); ///< between the last two good poses
  double last_interval_s_ = 0.0;                     ///< between the last two good poses
  Eigen::Vector3d velocity_m_s_ = Eigen::Vector3d::Zero();
  Point before_last_; ///< the good pose before, and the velocity then
  Eigen::Vector3d velocity_before_m_s_ = Eigen::Vector3d::Zero();
  double pace_s_ = 0.0; ///< the interval between records, but for the missing ones
  bool has_last_ = false;
  bool has_velocity_ = false;
  bool has_doubted_ = false; ///< since the last good pose
  bool has_restarted_ = false;
  int refusals_in_a_row_ = 0;
  std::uint64_t refused_ = 0;
  std::uint64_t flips_ = 0;
};

} // namespace nendo::hand
