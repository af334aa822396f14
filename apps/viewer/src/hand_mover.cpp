#include <nendo/viewer/hand_mover.hpp>

#include <algorithm>
#include <limits>

#include <nendo/base/units.hpp>

namespace nendo::viewer {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;

namespace {

// Of the wrist from the stage's middle: as far as arms reach, and in the picture.
constexpr double most_m = 2.0;
constexpr double degrees_a_pixel = 0.35; // as the camera turns

// Infinite for what is behind the camera.
double pixels_between(const Eigen::Matrix4d& clip_of_world, const Vector3d& place,
                      const Vector2d& pointer, Size size) noexcept {
  const Vector4d clip = clip_of_world * place.homogeneous();
  if (!(clip.w() > 0.0)) return std::numeric_limits<double>::infinity();
  const Vector2d in_picture = clip.head<2>() / clip.w();
  const Vector2d pixel((1.0 + in_picture.x()) / 2 * size.width,
                       (1.0 - in_picture.y()) / 2 * size.height);
  return (pixel - pointer).norm();
}

} // namespace

void HandMover::take(const Camera& camera, const flow::Frame& frame, const Vector2d& pointer,
                     Size size) noexcept {
  slot_.reset();
  const Eigen::Matrix4d clip = camera.projection(1.0 * size.width / size.height);
  double nearest = reach;
  for (std::size_t slot = 0; slot < frame.hands.size(); ++slot) {
    const auto& hand = frame.hands[slot];
    if (!hand.present) continue;
    for (const auto& joint : hand.pose.joints) {
      const double distance = pixels_between(clip, joint.translation(), pointer, size);
      if (!(distance < nearest)) continue;
      nearest = distance;
      slot_ = slot;
      wrist_ = hand.T_stage_wrist;
    }
  }
}

void HandMover::go_by(const Vector3d& way_m) noexcept {
  wrist_.translation() = (wrist_.translation() + way_m).cwiseMax(-most_m).cwiseMin(most_m);
}

void HandMover::shift(const Camera& camera, double dx, double dy, double height) noexcept {
  const Eigen::Matrix3d rows = camera.axes();
  const double depth_m = std::max(0.0, rows.row(2).dot(camera.eye() - wrist_.translation()));
  const double metres = 2.0 * camera.tangent() * depth_m / std::max(1.0, height);
  go_by(metres * (dx * rows.row(0) - dy * rows.row(1)).transpose());
}

void HandMover::turn(const Camera& camera, double dx, double dy) noexcept {
  const Eigen::Matrix3d rows = camera.axes();
  const Eigen::AngleAxisd about_up(from_degrees(degrees_a_pixel * dx), rows.row(1).transpose());
  const Eigen::AngleAxisd about_level(from_degrees(degrees_a_pixel * dy), rows.row(0).transpose());
  const Eigen::Quaterniond turned = about_level * about_up * Eigen::Quaterniond(wrist_.linear());
  wrist_.linear() = turned.normalized().toRotationMatrix();
}

void HandMover::push(const Camera& camera, double steps) noexcept {
  constexpr double step_m = 0.01;
  go_by(-step_m * std::clamp(steps, -20.0, 20.0) * camera.axes().row(2).transpose());
}

flow::WristMove HandMover::move() const noexcept {
  const Side side = slot_ == flow::Placement::index_of(Side::left) ? Side::left : Side::right;
  return flow::WristMove::to(side, wrist_);
}

} // namespace nendo::viewer
