#pragma once
// The position of a wrist, which no glove measures, and the switch at it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/base/api.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::flow {

/// Sets a wrist's pose, which the hand keeps until the next move, for example by a mouse. A wrist
/// that a tracker moves goes to this position and heading, and follows the tracker from there.
struct NENDO_API WristMove {
  Side side = Side::right;                     ///< the hand's side on the stage
  std::array<double, 3> position_m{};          ///< on the stage
  std::array<double, 4> turn_xyzw{0, 0, 0, 1}; ///< a quaternion, which is normalised

  static constexpr double farthest_m = 100.0;

  static WristMove to(Side side, const Eigen::Isometry3d& T_stage_wrist) noexcept;
  /// Returns whether each coordinate is within farthest_m and the quaternion is not zero. The loop
  /// refuses a move that is not usable.
  bool is_usable() const noexcept;
  /// The message for a refused move.
  static constexpr std::string_view refusal =
      "a hand cannot be moved there: it must stay within 100 m of the stage's middle on each axis, "
      "and its turn must be a quaternion that is not zero";
  /// Returns T_stage_wrist. The move must be usable.
  Eigen::Isometry3d pose() const noexcept;

  friend bool operator==(const WristMove&, const WristMove&) = default;
};

/// The wrist poses of a simulated hand over time.
class NENDO_API WristPath {
public:
  /// `poses` are on the stage, at intervals of `step_s`; at least two.
  WristPath(std::vector<Eigen::Isometry3d> poses, double step_s);

  /// A place on the path: the fraction `part` (0 to 1) from pose `first` to the next one.
  struct Place {
    std::size_t first = 0;
    double part = 0.0;
  };
  /// Returns the place at a time since the beginning, clamped to the first and last poses. A time
  /// that is not finite counts as 0. Thread-safe, wait-free.
  Place place(double time_s) const noexcept;
  /// Returns the pose at that time. Interpolates positions linearly, and rotations by the shortest
  /// arc. Thread-safe, wait-free.
  Eigen::Isometry3d at(double time_s) const noexcept;
  double length_s() const noexcept { return step_s_ * static_cast<double>(poses_.size() - 1); }

private:
  std::vector<Eigen::Isometry3d> poses_;
  double step_s_;
};

/// Returns the interpolated pose: `part` 0 is `from`, and 1 is `to`.
NENDO_API Eigen::Isometry3d blended(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to,
                                    double part) noexcept;

/// The action of both hands' wrist switches. Recordings keep the numbers, so new values are added
/// at the end.
enum class SwitchAction : std::uint8_t {
  none,   ///< nothing: the hands hold the model all the time
  grab,   ///< the hands hold the model while a switch is on
  commit, ///< turning a switch on commits the shape
  toggle, ///< turning a switch on makes the hands release the model, or grab it again
  keep,   ///< turning a switch on saves the recent input; the loop ignores it
};

NENDO_API std::string_view name_of(SwitchAction action) noexcept;
NENDO_API std::optional<SwitchAction> switch_action_named(std::string_view name) noexcept;

/// Debounces the switch, sample by sample, and detects when it is turned on. Uses no clock and no
/// I/O.
class NENDO_API WristSwitchEdge {
public:
  /// A position counts after this time and at least two samples, because contacts bounce for some
  /// milliseconds, and a damaged status byte lasts one sample.
  static constexpr std::chrono::milliseconds settling_time{20};

  /// Returns true if this sample turns the switch on. The first known position is the initial one.
  /// Ignores samples without a position.
  bool turned_on(WristSwitch position, HostTime time) noexcept;
  bool is_on() const noexcept { return settled_ == WristSwitch::on; }

private:
  WristSwitch settled_ = WristSwitch::unknown;
  std::optional<HostTime> differs_since_;
};

} // namespace nendo::flow
