#pragma once
// The mouse as what tells where a hand is, for people whose gloves, or whose simulated hands, have
// no tracker.

#include <cstddef>
#include <optional>

#include <nendo/flow/frame.hpp>
#include <nendo/flow/wrist_move.hpp>
#include <nendo/viewer/camera.hpp>
#include <nendo/viewer/image.hpp>

namespace nendo::viewer {

/// Holds a hand from the pointer's going down to its coming up.
class HandMover {
public:
  /// Takes the hand with the joint nearest to the pointer, in pixels from the picture's top left;
  /// none within `reach`: nothing is held.
  static constexpr double reach = 60.0;
  void take(const Camera& camera, const flow::Frame& frame, const Eigen::Vector2d& pointer,
            Size size) noexcept;
  void let_go() noexcept { slot_.reset(); }
  bool holds() const noexcept { return slot_.has_value(); }

  /// By pixels of the pointer's way: in the picture's plane, so that the hand stays under it.
  void shift(const Camera& camera, double dx, double dy, double height) noexcept;
  /// About its wrist, and the picture's upright and level axes.
  void turn(const Camera& camera, double dx, double dy) noexcept;
  /// By steps of the wheel, 1 cm each: forward is away from the viewer.
  void push(const Camera& camera, double steps) noexcept;

  /// Where the hand that is held is to be.
  flow::WristMove move() const noexcept;

private:
  void go_by(const Eigen::Vector3d& way_m) noexcept;

  std::optional<std::size_t> slot_;                         ///< flow::Placement::index_of(side)
  Eigen::Isometry3d wrist_ = Eigen::Isometry3d::Identity(); ///< T_stage_wrist
};

} // namespace nendo::viewer
