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

/// Says where a hand is in space. The hand stays there until it is moved again, for example with a
/// mouse or a tracker.
struct NENDO_API WristMove {
  Side side = Side::right;                     ///< as which the hand shapes
  std::array<double, 3> position_m{};          ///< on the stage
  std::array<double, 4> turn_xyzw{0, 0, 0, 1}; ///< a quaternion; read as if of length 1

  static constexpr double farthest_m = 100.0;

  static WristMove to(Side side, const Eigen::Isometry3d& T_stage_wrist) noexcept;
  /// Returns whether the position is within farthest_m of the stage's middle and the quaternion is
  /// not zero. The loop refuses a move that is not usable.
  bool is_usable() const noexcept;
  /// What is said where a move is refused.
  static constexpr std::string_view refusal =
      "a hand cannot be moved there: it must stay within 100 m of the stage's middle on each axis, "
      "and its turn must be a quaternion that is not zero";
  /// Returns T_stage_wrist. The move must be usable.
  Eigen::Isometry3d pose() const noexcept;

  friend bool operator==(const WristMove&, const WristMove&) = default;
};

/// Where a simulated hand's wrist is at each time.
class NENDO_API WristPath {
public:
  /// Poses on the stage, evenly in time, at least two.
  WristPath(std::vector<Eigen::Isometry3d> poses, double step_s);

  /// A time between two poses: `part` of the way from `first` to the next one, 0 to 1.
  struct Place {
    std::size_t first = 0;
    double part = 0.0;
  };
  /// Returns where a time since the beginning lies: before it at the first pose, after the end at
  /// the last one. A time that is not finite counts as 0. Thread-safe, wait-free.
  Place place(double time_s) const noexcept;
  /// Returns the pose at that time. Between two poses it is a line and the shortest turn.
  /// Thread-safe, wait-free.
  Eigen::Isometry3d at(double time_s) const noexcept;
  double length_s() const noexcept { return step_s_ * static_cast<double>(poses_.size() - 1); }

private:
  std::vector<Eigen::Isometry3d> poses_;
  double step_s_;
};

/// Returns the pose that is `part` of the way from one pose to another: 0 is `from`, and 1 is `to`.
NENDO_API Eigen::Isometry3d blended(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to,
                                    double part) noexcept;

/// What the switches of both hands do. Recordings keep the numbers, so new values are added at the
/// end.
enum class SwitchAction : std::uint8_t {
  none,   ///< nothing: the hands hold the model all the time
  grab,   ///< the hands hold the model while a switch is on
  commit, ///< turning one on makes the shape so far the rest shape, and the hands hold it again
  toggle, ///< turning one on has the hands release the model, the next time grab it again
  keep,   ///< turning one on keeps what was just done: a recorder's task, nothing to the loop
};

NENDO_API std::string_view name_of(SwitchAction action) noexcept;
NENDO_API std::optional<SwitchAction> switch_action_named(std::string_view name) noexcept;

/// Reads the switch's position sample by sample, and detects when it was really turned. It is pure:
/// no clock, no I/O.
class NENDO_API WristSwitchEdge {
public:
  /// A position counts once it has lasted this long and for at least two samples, because contacts
  /// bounce for some milliseconds, and a damaged status byte lasts one sample.
  static constexpr std::chrono::milliseconds settling_time{20};

  /// Returns true if the switch has just been turned on. The first known position is taken as the
  /// position from the start on. A sample without a position is ignored.
  bool turned_on(WristSwitch position, HostTime time) noexcept;
  bool is_on() const noexcept { return settled_ == WristSwitch::on; }

private:
  WristSwitch settled_ = WristSwitch::unknown;
  std::optional<HostTime> differs_since_;
};

} // namespace nendo::flow
