#pragma once
// The filter between measured angles and the pose: the 1-euro filter of G. Casiez, N. Roussel and
// D. Vogel ("1 Euro Filter: A Simple Speed-based Low-pass Filter for Noisy Input in Interactive
// Systems", CHI 2012), one for each angle. Slow joints are smoothed hard, fast ones hardly, because
// jitter is seen at rest and lag in motion. It is late by what it smooths, and says by how much.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include <nendo/base/units.hpp>
#include <nendo/hand/joint_angles.hpp>

namespace nendo::hand {

enum class FilterKind : std::uint8_t { off, one_euro };

/// "off", "one-euro".
std::string_view name_of(FilterKind kind) noexcept;
std::optional<FilterKind> filter_named(std::string_view name) noexcept;

/// The cutoff of a joint is min_cutoff_hz + beta_hz_per_rad_s |speed|. The defaults were chosen
/// with a CyberGlove's count of 0.0125 rad at 90 Hz: a sensor that flickers between two counts
/// comes out at a quarter, and reaches of 1.2 rad in 0.2, 0.5 and 1 s are 12, 16 and 21 ms late.
struct FilterOptions {
  FilterKind kind = FilterKind::off;
  double min_cutoff_hz = 2.0;
  double beta_hz_per_rad_s = 4.0;
  double derivative_cutoff_hz = 1.0; ///< of the speed's own filter, the authors' value
};

/// The filter's delay now, seconds, over all angles.
struct FilterLatency {
  double worst_s = 0.0; ///< of the slowest joint's: 1 / (2 pi min_cutoff) if any rests
  double mean_s = 0.0;
  /// The mean with each joint counted by its speed: how late that is which moves. The plain mean
  /// if nothing moves.
  double moving_s = 0.0;
};

class JointFilter {
public:
  /// A pause longer than this, or a clock that went back farther, begins anew.
  static constexpr double longest_interval_s = 0.5;

  /// Cutoffs are kept to 0.001 to 100000 Hz, beta to 0 to 100000; NaN becomes the least of them.
  explicit JointFilter(const FilterOptions& options = {}) noexcept;

  /// The filtered angles at `time`, that of the sample which they were made from. The first ones,
  /// and the first after a pause, pass as they are; so do all with FilterKind::off. Never outside
  /// of what came in since. A time that has not advanced counts as no time: the filtered angles
  /// stay, and the change counts as movement. An angle that is not finite, or more than a turn, is
  /// passed over: that joint stays (at 0, if it is the first). Wait-free, no allocation.
  JointAngles pass(const JointAngles& angles, HostTime time) noexcept;

  /// The joint's delay at its present cutoff: 1 / (2 pi cutoff), the group delay of a first-order
  /// lag at low frequencies, and by how much its output follows a steady movement; at any sample
  /// rate. 0 if off, and before the first sample.
  double latency_s(Angle angle) const noexcept;
  FilterLatency latency() const noexcept;

  const FilterOptions& options() const noexcept { return options_; }

private:
  struct Joint {
    double last_rad = 0.0;     ///< as it came in
    double filtered_rad = 0.0; ///< as it went out
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
