#pragma once
// The mouse as what tells where a fingertip is to be.

#include <optional>

#include <nendo/hand/skeleton.hpp>
#include <nendo/viewer/camera.hpp>
#include <nendo/viewer/image.hpp>

namespace nendo::viewer {

/// Holds a fingertip from the pointer's going down to its coming up.
class TipMover {
public:
  /// The fingertip of a hand nearest to the pointer, in pixels from the picture's top left; nothing
  /// if none is within `reach`.
  static constexpr double reach = 14.0;
  static std::optional<hand::Finger> tip_at(const Camera& camera, const hand::HandPose& pose,
                                            const Eigen::Vector2d& pointer, Size size) noexcept;

  void take(const hand::HandPose& pose, hand::Finger finger) noexcept;
  void let_go() noexcept { finger_.reset(); }
  std::optional<hand::Finger> finger() const noexcept { return finger_; } ///< that is held

  /// By pixels of the pointer's way: in the picture's plane, so that it stays under it.
  void shift(const Camera& camera, double dx, double dy, double height) noexcept;
  /// By steps of the wheel, 1 cm each: forward is away from the viewer.
  void push(const Camera& camera, double steps) noexcept;
  /// Where the tip that is held is to be; on the stage, metres, within 2 m of its middle.
  const Eigen::Vector3d& target_m() const noexcept { return target_m_; }

private:
  void go_by(const Eigen::Vector3d& way_m) noexcept;

  std::optional<hand::Finger> finger_;
  Eigen::Vector3d target_m_ = Eigen::Vector3d::Zero();
};

} // namespace nendo::viewer
