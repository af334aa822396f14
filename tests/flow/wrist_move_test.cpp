#include <nendo/flow/wrist.hpp>

#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"

namespace wrist_move_test {

using namespace nendo;
using namespace nendo::flow;
using Eigen::Isometry3d;
using Eigen::Vector3d;

TEST_SUITE("wrist_move") {
  TEST_CASE("what is not a place near the stage, or no turn, is not usable") {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    CHECK(WristMove{}.is_usable());
    for (const double bad : {nan, infinity, -infinity, 1e300, -100.1})
      for (std::size_t at = 0; at < 3; ++at) {
        WristMove move;
        move.position_m[at] = bad;
        CHECK_FALSE(move.is_usable());
      }
    for (const double bad : {nan, infinity, 1e300, 0.0})
      CHECK_FALSE(WristMove{Side::left, {}, {0, 0, 0, bad}}.is_usable());
    CHECK(WristMove{Side::left, {100, -100, 0}, {0, 0, 0, 5}}.is_usable());
  }

  TEST_CASE("a pose goes into a move and comes out of it") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (int round = 0; round < 100; ++round) {
      Isometry3d pose = Isometry3d::Identity();
      pose.translation() = Vector3d(any(random), any(random), any(random));
      pose.rotate(Eigen::AngleAxisd(3.0 * any(random),
                                    Vector3d(any(random), any(random), 2.0).normalized()));
      const WristMove move = WristMove::to(Side::left, pose);
      CHECK(move.is_usable());
      CHECK(move.side == Side::left);
      CHECK((move.pose().matrix() - pose.matrix()).norm() < 1e-12);
    }
  }

  TEST_CASE("a hand that is moved takes its fingertips along, the other stays") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      test::LoopUnderTest test(mode);
      const Frame before = test.frame_after_tick(0);
      Isometry3d wrist = test.placement.T_stage_wrist[0];
      wrist.pretranslate(Vector3d(0.0, 0.02, 0.01));
      REQUIRE(test.commands.try_push(WristMove::to(Side::left, wrist)));
      const Frame& after = test.frame_after_tick(1);
      const Fingertips way =
          after.hands[0].pose.fingertip_positions() - before.hands[0].pose.fingertip_positions();
      CHECK((way.colwise() - Vector3d(0.0, 0.02, 0.01)).norm() < 1e-12);
      CHECK(after.hands[1].pose.fingertip_positions() ==
            before.hands[1].pose.fingertip_positions());
      CHECK((after.hands[0].T_stage_wrist.matrix() - wrist.matrix()).norm() < 1e-12);
      CHECK((test.vertices_of(after) - test.model.vertices).cwiseAbs().maxCoeff() > 1e-3);
      CHECK(after.hands[1].T_stage_wrist.matrix() == test.placement.T_stage_wrist[1].matrix());
    }
  }

  TEST_CASE("the last of several moves counts, and what is not usable changes nothing") {
    test::LoopUnderTest test(Mode::type1);
    const Isometry3d wrist = test.placement.T_stage_wrist[1];
    for (const double up : {0.5, 0.1, 0.03})
      REQUIRE(test.commands.try_push(
          WristMove::to(Side::right, Eigen::Translation3d(0.0, up, 0.0) * wrist)));
    WristMove hostile = WristMove::to(Side::right, wrist);
    hostile.turn_xyzw[2] = std::numeric_limits<double>::quiet_NaN();
    REQUIRE(test.commands.try_push(hostile));
    const Frame& frame = test.frame_after_tick(0);
    const Vector3d way = frame.hands[1].T_stage_wrist.translation() - wrist.translation();
    CHECK((way - Vector3d(0.0, 0.03, 0.0)).norm() < 1e-12);
    CHECK(test.vertices_of(frame).allFinite());
  }
}

} // namespace wrist_move_test
