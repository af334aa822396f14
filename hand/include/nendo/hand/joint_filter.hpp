#pragma once
// The filter between measured angles and the pose: the 1-euro filter of G. Casiez, N. Roussel and
// D. Vogel ("1 Euro Filter: A Simple Speed-based Low-pass Filter for Noisy Input in Interactive
// Systems", CHI 2012), one for each angle. Slow joints are smoothed strongly and fast joints
// little, because jitter is seen at rest and lag in motion. Smoothing delays the angles; latency()
// returns the delay.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include <nendo/base/units.hpp>
#include <nendo/hand/joint_angles.hpp>

namespace nendo::hand {

enum class FilterKind : std::uint8_t { off, one_euro };

NENDO_API std::string_view name_of(FilterKind kind) noexcept;
NENDO_API std::optional<FilterKind> filter_named(std::string_view name) noexcept;

/// The cutoff of a joint is min_cutoff_hz + beta_hz_per_rad_s |speed|. The defaults were chosen
/// with a CyberGlove's count of 0.0125 rad at 90 Hz: a flicker between two counts is reduced to a
/// quarter, and movements of 1.2 rad in 0.2, 0.5 and 1 s are delayed by 12, 16 and 21 ms.
struct FilterOptions {
  FilterKind kind = FilterKind::off;
  double min_cutoff_hz = 2.0;
  double beta_hz_per_rad_s = 4.0;
  double derivative_cutoff_hz = 1.0; ///< cutoff of the speed filter; the authors' value
  /// Whether pinches are closed after the filter (pinch_closing.hpp). JointFilter ignores it.
  bool close_pinches = false;

  friend bool operator==(const FilterOptions&, const FilterOptions&) = default;
};

/// The filter's current delay over all angles, in seconds.
struct FilterLatency {
  double worst_s = 0.0; ///< the slowest joint: 1 / (2 pi min_cutoff) if any rests
  double mean_s = 0.0;
  /// The mean weighted by the joints' speeds, that is, the delay of moving joints; the unweighted
  /// mean if no joint moves.
  double moving_s = 0.0;
};

class NENDO_API JointFilter {
public:
  /// The filter restarts after a longer pause, or if time steps back by more.
  static constexpr double longest_interval_s = 0.5;

  /// Limits the cutoffs to 0.001 to 100000 Hz and beta to 0 to 100000; NaN becomes the lower limit.
  explicit JointFilter(const FilterOptions& options = {}) noexcept;

  /// Returns the filtered angles at `time`, the time of the sample from which `angles` were made.
  /// The first angles, and the first after a pause, pass unchanged; with FilterKind::off all do.
  /// The output never leaves the range of the input since the last restart. If time has not
  /// advanced, the filtered angles stay, and the change counts as movement. An angle that is not
  /// finite or exceeds a full turn is ignored: its joint keeps the last angle (0 at first).
  /// Wait-free, no allocation.
  JointAngles pass(const JointAngles& angles, HostTime time) noexcept;

  /// Returns the joint's delay at its present cutoff: 1 / (2 pi cutoff), in seconds. This is the
  /// group delay of a first-order lag at low frequencies, and the lag of the output at constant
  /// speed, at any sample rate. It is 0 if the filter is off, and before the first sample.
  double latency_s(Angle angle) const noexcept;
  FilterLatency latency() const noexcept;

  const FilterOptions& options() const noexcept { return options_; }

private:
  struct Joint {
    double last_rad = 0.0;     ///< the last input
    double filtered_rad = 0.0; ///< the last output
    double speed_rad_s = 0.0;  ///< filtered
  };
  double time_constant_s(const Joint& joint) const noexcept;
  void step(Joint& joint, double angle_rad, double interval_s) const noexcept;

  FilterOptions options_;
  std::array<Joint, angle_count> joints_{};
  HostTime last_time_{};
  bool begun_ = false;
};

} // namespace nendo::hand
