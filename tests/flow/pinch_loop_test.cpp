// The loop closes pinches when its settings say so, and never in clay.

#include <doctest/doctest.h>

#include <nendo/hand/pinch_closing.hpp>

#include "support/eventually.hpp"
#include "support/flow_fixtures.hpp"
#include "support/pinching_sample.hpp"

namespace pinch_loop_test {

using namespace nendo;
using flow::Mode;
using hand::Joint;

namespace {

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
      const GloveSample pinch = test::pinching_sample(Side::right, now);
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
      flow::LoopSettings settings = test.loop->changes().settings();
      CHECK(settings.filter.close_pinches);
      const auto change = [&](bool wanted) {
        REQUIRE(test.loop->changes().change_settings(settings));
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
