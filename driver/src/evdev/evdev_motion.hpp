#pragma once
// Moves a pose by the events of an input device. It is pure (no I/O, clock, log or allocation), and
// no event moves the pose out of a box around the start. Its axes are the stage's: x to the
// operator's right, y up, z towards the operator.
//
// A deflected axis is a speed. A SpaceMouse's own axes are x to the right, y towards the operator
// and z down (spacenavd's default map exchanges y and z and inverts both). A gamepad's left stick
// moves in the plane x y, its triggers away and back, and its right stick turns. The movements of a
// mouse and of its wheel are movements of the pose. The device's first button moves the pose back
// to the start.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include <nendo/base/units.hpp>

#include "evdev/evdev_parser.hpp"
#include "evdev/input_device.hpp"

namespace nendo::driver::evdev {

inline constexpr std::size_t axes = 6;    ///< X Y Z RX RY RZ, the same codes for ABS_ and REL_
inline constexpr double box_half_m = 0.5; ///< chosen: an arm's reach around the start
/// A REL_ axis at rest sends nothing, so one of a SpaceMouse, which repeats deflected ones every 8
/// to 24 ms, is at rest after this time.
inline constexpr std::chrono::milliseconds relative_rest{60};
/// The time in which the first button moves the pose back.
inline constexpr std::chrono::milliseconds return_time{500};

struct MotionScale {
  double speed_m_s = 0.25; ///< at full deflection; a mouse moves the pose 0.4 ms of it per count
  double turn_rad_s = 1.0; ///< at full deflection
};

/// The range of an axis. The default is that of a SpaceMouse, whose REL_ axes have none.
struct AxisRange {
  std::int32_t min = -350;
  std::int32_t max = 350;
  std::int32_t flat = 0; ///< the device calls deflections up to this value rest
};

struct InputPose {
  std::array<double, 3> position_m{};
  std::array<double, 4> turn_xyzw{0, 0, 0, 1};
};

class EvdevMotion {
public:
  explicit EvdevMotion(const MotionScale& scale) noexcept : scale_(scale) {}

  /// Sets the kind of device, whose axes are at rest. The pose stays.
  void set_device(InputKind kind, std::uint16_t first_button) noexcept;
  /// Ranges that contain nothing are replaced by the default.
  void set_range(std::size_t axis, const AxisRange& range) noexcept;
  void set_value(std::size_t axis, std::int32_t value) noexcept;
  /// The value of an axis at rest.
  std::int32_t resting_value(std::size_t axis) const noexcept;

  /// Takes an event that arrived at `now`, which never runs back.
  void take(const Event& event, HostTime now) noexcept;
  /// Moves the pose to `now`. Times of more than 0.1 s count as 0.1 s.
  void advance(HostTime now) noexcept;

  bool is_moving() const noexcept; ///< the pose will change without a further event
  /// The kernel dropped events: all axes are at rest until set_value() gets their true values.
  bool needs_values() const noexcept { return needs_values_; }
  const InputPose& pose() const noexcept { return pose_; }

private:
  void rest() noexcept;
  void take_relative(const Event& event, HostTime now) noexcept;
  void begin_return() noexcept;
  void move_back(double seconds) noexcept;
  void move_by_axes(double seconds) noexcept;
  bool is_trigger(std::size_t axis) const noexcept;

  const MotionScale scale_;
  InputKind kind_ = InputKind::mouse;
  std::uint16_t first_button_ = 0;
  std::array<AxisRange, axes> ranges_{};
  std::array<double, axes> deflections_{}; ///< from -1 to 1, of a trigger from 0
  std::array<HostTime, axes> updated_{};
  InputPose pose_;
  std::array<double, 3> pending_m_{}; ///< movement of a mouse that the pose has yet to make
  InputPose return_from_;
  double returned_s_ = 0.0;
  bool returning_ = false;
  bool dropped_ = false; ///< events are dropped until the next SYN_REPORT
  bool needs_values_ = false;
  HostTime last_{};
};

} // namespace nendo::driver::evdev
