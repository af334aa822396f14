#pragma once
// Moves a fingertip with the mouse.

#include <optional>

#include <nendo/hand/skeleton.hpp>

#include "render/camera.hpp"
#include "render/image.hpp"

namespace nendo::viewer {

/// Holds a fingertip from the moment the mouse button goes down until it comes up.
class TipMover {
public:
  /// Returns the fingertip of a hand that is nearest to the pointer, which is in pixels from the
  /// picture's top left corner. Returns nothing if none is within `reach` pixels.
  static constexpr double reach = 14.0;
  static std::optional<hand::Finger> tip_at(const render::Camera& camera,
                                            const hand::HandPose& pose,
                                            const Eigen::Vector2d& pointer,
                                            render::Size size) noexcept;

  void take(const hand::HandPose& pose, hand::Finger finger) noexcept;
  void let_go() noexcept { finger_.reset(); }
  std::optional<hand::Finger> finger() const noexcept { return finger_; } ///< that is held

  /// Moves the tip by the pixels that the pointer moved, in the picture's plane, so that the tip
  /// stays under the pointer. `height` is the picture's height in pixels.
  void shift(const render::Camera& camera, double dx, double dy, double height) noexcept;
  /// Moves the tip by steps of the wheel, 1 cm each. Positive steps go away from the viewer.
  void push(const render::Camera& camera, double steps) noexcept;
  /// Returns the place on the stage to which the held tip must go, in metres. Each coordinate is
  /// within 2 m of the stage's middle.
  const Eigen::Vector3d& target_m() const noexcept { return target_m_; }

private:
  void go_by(const Eigen::Vector3d& way_m) noexcept;

  std::optional<hand::Finger> finger_;
  Eigen::Vector3d target_m_ = Eigen::Vector3d::Zero();
};

} // namespace nendo::viewer
