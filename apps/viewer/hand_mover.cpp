#include "viewer/hand_mover.hpp"

#include <algorithm>

#include <nendo/base/units.hpp>

#include "viewer/pointing.hpp"

namespace nendo::viewer {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

// Of the wrist from the middle of the picture, on each axis: as far as arms reach.
constexpr double max_reach_m = 2.0;
constexpr double degrees_per_pixel = 0.35; // as the camera turns
constexpr double max_tip_m = 2.0;          // from the stage's middle, as far as arms reach

} // namespace

void HandMover::take(const render::Camera& camera, const flow::Frame& frame,
                     const Vector2d& pointer, render::Size size) noexcept {
  slot_.reset();
  double nearest = reach;
  for (std::size_t slot = 0; slot < frame.hands.size(); ++slot) {
    const auto& hand = frame.hands[slot];
    if (!hand.present) continue;
    for (const auto& joint : hand.pose.joints) {
      const auto pixel = pixel_of(camera, joint.translation(), size);
      if (!pixel || !((*pixel - pointer).norm() < nearest)) continue;
      nearest = (*pixel - pointer).norm();
      slot_ = slot;
      wrist_ = hand.T_stage_wrist;
    }
  }
  // About what is looked at: a model need not be in the stage's middle. A hand that is farther
  // away already stays where it is.
  const Vector3d reach_m = Vector3d::Constant(max_reach_m);
  lowest_m_ = wrist_.translation().cwiseMin(camera.target - reach_m);
  highest_m_ = wrist_.translation().cwiseMax(camera.target + reach_m);
}

void HandMover::go_by(const Vector3d& way_m) noexcept {
  wrist_.translation() = (wrist_.translation() + way_m).cwiseMax(lowest_m_).cwiseMin(highest_m_);
}

void HandMover::shift(const render::Camera& camera, double dx, double dy, double height) noexcept {
  go_by(way_in_picture(camera, wrist_.translation(), dx, dy, height));
}

void HandMover::turn(const render::Camera& camera, double dx, double dy) noexcept {
  const Eigen::Matrix3d rows = camera.axes();
  const Eigen::AngleAxisd about_up(from_degrees(degrees_per_pixel * dx), rows.row(1).transpose());
  const Eigen::AngleAxisd about_level(from_degrees(degrees_per_pixel * dy),
                                      rows.row(0).transpose());
  const Eigen::Quaterniond turned = about_level * about_up * Eigen::Quaterniond(wrist_.linear());
  wrist_.linear() = turned.normalized().toRotationMatrix();
}

void HandMover::push(const render::Camera& camera, double steps) noexcept {
  go_by(way_by_wheel(camera, steps));
}

flow::WristMove HandMover::move() const noexcept {
  const Side side = slot_ == flow::Placement::index_of(Side::left) ? Side::left : Side::right;
  return flow::WristMove::to(side, wrist_);
}

std::optional<hand::Finger> TipMover::tip_at(const render::Camera& camera,
                                             const hand::HandPose& pose,
                                             const Eigen::Vector2d& pointer,
                                             render::Size size) noexcept {
  std::optional<hand::Finger> found;
  double nearest = reach;
  const auto tips = pose.fingertip_positions();
  for (Eigen::Index finger = 0; finger < tips.cols(); ++finger) {
    const auto pixel = pixel_of(camera, tips.col(finger), size);
    if (!pixel || !((*pixel - pointer).norm() < nearest)) continue;
    nearest = (*pixel - pointer).norm();
    found = static_cast<hand::Finger>(finger);
  }
  return found;
}

void TipMover::take(const hand::HandPose& pose, hand::Finger finger) noexcept {
  finger_ = finger;
  target_m_ = pose.fingertip_positions().col(static_cast<Eigen::Index>(finger));
}

void TipMover::go_by(const Vector3d& way_m) noexcept {
  target_m_ = (target_m_ + way_m).cwiseMax(-max_tip_m).cwiseMin(max_tip_m);
}

void TipMover::shift(const render::Camera& camera, double dx, double dy, double height) noexcept {
  go_by(way_in_picture(camera, target_m_, dx, dy, height));
}

void TipMover::push(const render::Camera& camera, double steps) noexcept {
  go_by(way_by_wheel(camera, steps));
}

} // namespace nendo::viewer
