#include "viewer/tip_mover.hpp"

#include "viewer/pointing.hpp"

namespace nendo::viewer {

using Eigen::Vector3d;

namespace {

constexpr double max_tip_m = 2.0; // from the stage's middle, as far as arms reach

} // namespace

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
