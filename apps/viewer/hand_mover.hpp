#pragma once
// Moves a hand with the mouse, for people whose gloves or simulated hands have no tracker.

#include <cstddef>
#include <optional>

#include <nendo/flow/frame.hpp>
#include <nendo/flow/wrist_move.hpp>

#include "render/camera.hpp"
#include "render/image.hpp"

namespace nendo::viewer {

/// Holds a hand from the moment the mouse button goes down until it comes up.
class HandMover {
public:
  /// Takes the hand with the joint that is nearest to the pointer, which is in pixels from the
  /// picture's top left corner. Takes no hand if no joint is within `reach` pixels.
  static constexpr double reach = 60.0;
  void take(const render::Camera& camera, const flow::Frame& frame, const Eigen::Vector2d& pointer,
            render::Size size) noexcept;
  void let_go() noexcept { slot_.reset(); }
  bool holds() const noexcept { return slot_.has_value(); }

  /// Moves the hand by the pixels that the pointer moved, in the picture's plane, so that the hand
  /// stays under the pointer. `height` is the picture's height in pixels.
  void shift(const render::Camera& camera, double dx, double dy, double height) noexcept;
  /// Turns the hand about its wrist, around the picture's vertical and horizontal axes, by the
  /// pixels that the pointer moved.
  void turn(const render::Camera& camera, double dx, double dy) noexcept;
  /// Moves the hand by steps of the wheel, 1 cm each. Positive steps go away from the viewer.
  void push(const render::Camera& camera, double steps) noexcept;

  /// Returns the pose that the held hand's wrist must take.
  flow::WristMove move() const noexcept;

private:
  void go_by(const Eigen::Vector3d& way_m) noexcept;

  std::optional<std::size_t> slot_;                         ///< flow::Placement::index_of(side)
  Eigen::Isometry3d wrist_ = Eigen::Isometry3d::Identity(); ///< T_stage_wrist
  Eigen::Vector3d lowest_m_ = Eigen::Vector3d::Zero();      ///< where it may go, on the stage
  Eigen::Vector3d highest_m_ = Eigen::Vector3d::Zero();
};

} // namespace nendo::viewer
