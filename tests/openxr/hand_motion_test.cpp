// Joints at the time that an application asks for: by motions whose true course is known.

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "openxr/hand_motion.hpp"

namespace openxr_hand_motion_test {

using namespace nendo::openxr;

namespace {

constexpr std::int64_t start_ns = 1'000'000'000'000;
constexpr std::size_t wrist = 1, index_metacarpal = 6, index_tip = 10;

Eigen::Quaterniond about_x(double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitX()));
}

/// The hand after `time_s`: the wrist moves and turns, and the index bends at three joints.
HandPose bending(double time_s, double turn_rad_per_s, double bend_rad_per_s) {
  HandPose pose;
  for (JointPose& joint : pose)
    joint = {Eigen::Vector3d(0.01, 0.02, 0.03), Eigen::Quaterniond::Identity()};
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(turn_rad_per_s * time_s, Eigen::Vector3d(0.6, 0.0, 0.8)));
  pose[wrist] = {Eigen::Vector3d(0.5 * time_s, 1.0, -0.2 * time_s), turn};
  // Each bone is ahead (-z) of its joint.
  const std::array<double, 4> lengths_m{0.07, 0.045, 0.025, 0.02};
  pose[index_metacarpal] = {pose[wrist].position + turn * Eigen::Vector3d(0.02, 0.0, -0.03), turn};
  for (std::size_t bone = 0; bone < 4; ++bone) {
    const std::size_t k = index_metacarpal + bone;
    const double bend = -bend_rad_per_s * time_s * static_cast<double>(bone + 1);
    pose[k + 1] = {pose[k].position + pose[k].orientation * Eigen::Vector3d(0, 0, -lengths_m[bone]),
                   turn * about_x(bend)};
  }
  return pose;
}

PublishedHand published(double turn_rad_per_s, double bend_rad_per_s) {
  PublishedHand hand;
  hand.newest = bending(1.0, turn_rad_per_s, bend_rad_per_s);
  hand.newest_ns = start_ns + 1'000'000'000;
  hand.earlier = bending(0.98, turn_rad_per_s, bend_rad_per_s);
  hand.earlier_ns = start_ns + 980'000'000;
  hand.has_earlier = true;
  return hand;
}

} // namespace

TEST_SUITE("hand_motion") {
  TEST_CASE("at the newest record's time, joints are those of the record") {
    const PublishedHand hand = published(3.0, 2.0);
    const MovingHand moving = at_time(hand, hand.newest_ns);
    CHECK(moving.has_velocity);
    for (std::size_t k = 0; k < joint_count; ++k) {
      CHECK(moving.joints[k].position == hand.newest[k].position);
      CHECK(moving.joints[k].orientation.coeffs() == hand.newest[k].orientation.coeffs());
    }
  }

  TEST_CASE("velocities are those of the motion") {
    const MovingHand moving = at_time(published(3.0, 0.0), 0);
    CHECK((moving.angular_rad_per_s[index_tip] - 3.0 * Eigen::Vector3d(0.6, 0.0, 0.8)).norm() <
          1e-9);
    CHECK((moving.linear_m_per_s[wrist] - Eigen::Vector3d(0.5, 0.0, -0.2)).norm() < 1e-9);
    const MovingHand bent = at_time(published(0.0, 2.0), 0);
    CHECK(bent.angular_rad_per_s[index_tip].x() == doctest::Approx(-8.0));
  }

  TEST_CASE("extrapolation follows a steady motion, and bones keep their lengths") {
    const PublishedHand hand = published(3.0, 2.0);
    for (const int after_ms : {-50, -20, 10, 40, 50}) {
      const MovingHand moving = at_time(hand, hand.newest_ns + after_ms * 1'000'000);
      const HandPose truth = bending(1.0 + after_ms / 1000.0, 3.0, 2.0);
      CHECK((moving.joints[wrist].position - truth[wrist].position).norm() < 1e-9);
      // The axis of the bending turns meanwhile, which a constant angular velocity leaves out.
      for (std::size_t k = index_metacarpal; k <= index_tip; ++k)
        CHECK((moving.joints[k].position - truth[k].position).norm() < 2e-3);
      for (std::size_t k = index_metacarpal; k < index_tip; ++k)
        CHECK((moving.joints[k + 1].position - moving.joints[k].position).norm() ==
              doctest::Approx((truth[k + 1].position - truth[k].position).norm()));
    }
  }

  TEST_CASE("extrapolation ends after 50 ms, whatever the time") {
    const PublishedHand hand = published(3.0, 2.0);
    const auto tip_at = [&](std::int64_t time_ns) {
      return at_time(hand, time_ns).joints[index_tip].position;
    };
    constexpr auto max = std::numeric_limits<std::int64_t>::max();
    CHECK(tip_at(max) == tip_at(hand.newest_ns + 50'000'000));
    CHECK(tip_at(-max) == tip_at(hand.newest_ns - 50'000'000));
  }

  TEST_CASE("a silent hand, and one without an earlier pose, stay where they are") {
    PublishedHand hand = published(3.0, 2.0);
    SUBCASE("silent") {
      hand.is_silent = true;
    }
    SUBCASE("new") {
      hand.has_earlier = false;
    }
    const MovingHand moving = at_time(hand, hand.newest_ns + 30'000'000);
    CHECK_FALSE(moving.has_velocity);
    CHECK(moving.joints[index_tip].position == hand.newest[index_tip].position);
  }

  TEST_CASE("a turn goes the shorter way, whichever sign a quaternion has") {
    PublishedHand hand = published(3.0, 0.0);
    for (JointPose& joint : hand.earlier)
      joint.orientation.coeffs() = -joint.orientation.coeffs();
    CHECK(at_time(hand, 0).angular_rad_per_s[wrist].norm() == doctest::Approx(3.0));
  }
}

} // namespace openxr_hand_motion_test
