#include "bench/clay_scene.hpp"

#include <algorithm>
#include <cmath>

#include <nendo/flow/clay_hands.hpp>

namespace nendo::bench {

namespace {

using hand::HandBody;

constexpr double above_mm = 10.0; // where the hands begin and end
constexpr double mm_a_metre = 1000.0;

/// The way of a hand that has gone so far: how near it is to the ball, and how far to the side.
struct Gone {
  double down_mm, aside_mm;
};
Gone gone_at(double way_mm) {
  const double down = above_mm + ClayScene::depth_mm;
  const double aside = std::clamp(way_mm - down, 0.0, ClayScene::scrape_mm);
  const double up = std::clamp(way_mm - down - ClayScene::scrape_mm, 0.0, down);
  return {std::min(way_mm, down) - up, aside};
}

/// Palm down, fingers along +x, with the middle of the palm over the ball.
Eigen::Isometry3d wrist_above(const Gone& gone, double share, double side) {
  Eigen::Matrix3d axes; // of the wrist: -Z to the fingers, +Y out of the back
  axes.col(2) = -Eigen::Vector3d::UnitX();
  axes.col(1) = side * Eigen::Vector3d::UnitZ();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  constexpr double palm_mm = 16.5; // of flesh below the wrist's axis
  Eigen::Isometry3d wrist = Eigen::Isometry3d::Identity();
  wrist.linear() = axes;
  wrist.translation() << -70.0 + share * gone.aside_mm, 0.0,
      side * (ClayScene::ball_radius_mm + palm_mm + above_mm - gone.down_mm);
  wrist.translation() /= mm_a_metre;
  return wrist;
}

hand::JointAngles flat() {
  hand::JointAngles angles;
  for (auto& finger : angles.fingers)
    finger = {0.1, 0.0, 0.15, 0.1};
  angles.thumb_abduction_rad = 0.3;
  return angles;
}

} // namespace

ClayScene::ClayScene(int hands, double speed_m_s)
    : parts_(static_cast<std::size_t>(hands) * HandBody::part_count),
      step_mm_(speed_m_s * mm_a_metre / rate_hz),
      ticks_(static_cast<int>(std::ceil((2.0 * (above_mm + depth_mm) + scrape_mm) / step_mm_))) {
  for (int hand = 0; hand < hands; ++hand) {
    skeletons_.emplace_back(hand == 0 ? Side::right : Side::left);
    bodies_.emplace_back(skeletons_.back());
  }
}

std::span<const deform::ContactPart> ClayScene::at(int tick) {
  const Gone gone = gone_at(step_mm_ * tick);
  for (std::size_t hand = 0; hand < bodies_.size(); ++hand) {
    const hand::HandPose pose = skeletons_[hand].pose(
        flat(), hand == 0 ? wrist_above(gone, 1.0, 1.0) : wrist_above(gone, -0.5, -1.0));
    flow::contact_parts(bodies_[hand], pose, mm_a_metre,
                        {parts_.data() + hand * HandBody::part_count, HandBody::part_count});
  }
  return parts_;
}

} // namespace nendo::bench
