// The loop closes pinches when its settings say so, and never in clay.

#include <doctest/doctest.h>

#include <nendo/hand/inverse_kinematics.hpp>
#include <nendo/hand/pinch_closing.hpp>

#include "support/eventually.hpp"
#include "support/flow_fixtures.hpp"

namespace pinch_loop_test {

using namespace nendo;
using flow::Mode;
using hand::Joint;

namespace {

/// Counts of a hand whose thumb is some millimetres from its index finger, as the default
/// calibration reads them.
GloveSample pinching_sample(Side side, HostTime now) {
  const hand::HandSkeleton skeleton(side);
  hand::JointAngles start;
  start.thumb_roll_rad = 0.8;
  start.thumb_abduction_rad = 0.6;
  start[hand::Finger::index] = {0.8, 0.1, 0.8, 0.4};
  hand::FingertipTargets targets{};
  targets[0].weight = 1.0;
  targets[0].position_m =
      skeleton.pose(start, Eigen::Isometry3d::Identity())[Joint::index_tip].translation();
  const hand::JointAngles pinch =
      hand::inverse_kinematics(skeleton, Eigen::Isometry3d::Identity(), targets, start).angles;
  GloveSample sample = test::bent_sample(side, 0, now);
  const hand::Calibration calibration = hand::default_calibration();
  const auto set = [&](Sensor sensor, double angle_rad) {
    const auto& line = calibration.sensors[static_cast<std::size_t>(sensor)];
    sample.set(sensor, RawCount{static_cast<std::uint16_t>(line.offset_counts +
                                                           angle_rad / line.gain_rad_per_count)});
  };
  set(Sensor::thumb_roll, pinch.thumb_roll_rad);
  set(Sensor::thumb_abduction, pinch.thumb_abduction_rad);
  set(Sensor::thumb_mcp, pinch.thumb_mcp_flexion_rad);
  set(Sensor::thumb_ip, pinch.thumb_ip_flexion_rad);
  set(Sensor::index_mcp, pinch[hand::Finger::index].mcp_flexion_rad);
  set(Sensor::index_pip, pinch[hand::Finger::index].pip_flexion_rad);
  set(Sensor::index_dip, pinch[hand::Finger::index].dip_flexion_rad);
  return sample;
}

/// The places of both tips, from the wrist, in the last tick's frame.
Eigen::Matrix<double, 3, 2> tips_of(const flow::Frame& frame) {
  const hand::HandPose& pose = frame.hands[1].pose;
  Eigen::Matrix<double, 3, 2> tips;
  tips.col(0) = pose[Joint::thumb_tip].translation();
  tips.col(1) = pose[Joint::index_tip].translation();
  return tips;
}

} // namespace

TEST_SUITE("pinch_loop") {
  TEST_CASE("pinches close in a tick where the settings say so, and not in clay") {
    for (const Mode begun : {Mode::type1, Mode::type2, Mode::clay}) {
      CAPTURE(flow::name_of(begun));
      test::LoopUnderTest test(begun, {.rings_of_ball = 12, .close_pinches = true});
      const HostTime now = HostClock::now();
      const GloveSample pinch = pinching_sample(Side::right, now);
      const auto poses = [&](bool closed) {
        const hand::HandSkeleton skeleton(Side::right);
        hand::JointAngles angles = hand::joint_angles(pinch, hand::default_calibration());
        if (closed) angles = hand::close_pinches(angles, skeleton, pinch.present);
        const auto pose = skeleton.pose(angles, test.placement.T_stage_wrist[1]);
        Eigen::Matrix<double, 3, 2> tips;
        tips.col(0) = pose[Joint::thumb_tip].translation();
        tips.col(1) = pose[Joint::index_tip].translation();
        return tips;
      };
      REQUIRE((poses(true) - poses(false)).norm() > 1e-3);
      REQUIRE(test.rings[1]->try_push(pinch));
      std::uint64_t tick = 0;
      const auto is_closed = [&](bool wanted) {
        return (tips_of(test.frame_after_tick(tick++)) - poses(wanted)).norm() < 1e-12;
      };
      is_closed(false); // the gate may hold a sample back that jumps
      REQUIRE(test.rings[1]->try_push(pinch));
      REQUIRE(test.rings[1]->try_push(pinch));
      CHECK(is_closed(begun != Mode::clay));
      flow::LoopSettings settings = test.loop->settings();
      CHECK(settings.filter.close_pinches);
      const auto change = [&](bool wanted) {
        REQUIRE(test.loop->change_settings(settings));
        CHECK(test::eventually([&] { return is_closed(wanted); }));
      };
      settings.filter.close_pinches = false;
      change(false);
      settings.filter.close_pinches = true;
      change(begun != Mode::clay);
      settings.mode = begun == Mode::clay ? Mode::type1 : Mode::clay;
      change(begun == Mode::clay);
    }
  }
}

} // namespace pinch_loop_test
