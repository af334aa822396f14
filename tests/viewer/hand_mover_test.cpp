#include <doctest/doctest.h>

#include <nendo/base/units.hpp>

#include "support/flow_fixtures.hpp"
#include "viewer/pointing.hpp"

namespace hand_mover_test {

using namespace nendo;
using namespace nendo::render;
using namespace nendo::viewer;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr Size size{800, 600};

Vector2d pixel_of(const Camera& camera, const Vector3d& place) {
  const Eigen::Vector4d clip =
      camera.projection(1.0 * size.width / size.height) * place.homogeneous();
  return {(1.0 + clip.x() / clip.w()) / 2 * size.width,
          (1.0 - clip.y() / clip.w()) / 2 * size.height};
}

Camera looking_at(const flow::Frame& frame) {
  Camera camera;
  camera.view = {25.0, 15.0};
  camera.target = frame.hands[0].T_stage_wrist.translation();
  return camera;
}

Vector3d place_of(const flow::WristMove& move) {
  return move.pose().translation();
}

} // namespace

TEST_SUITE("hand_mover") {
  TEST_CASE("it takes the hand under the pointer, and none where none is") {
    test::LoopUnderTest test(flow::Mode::type1);
    const flow::Frame& frame = test.frame_after_tick(0);
    const Camera camera = looking_at(frame);
    HandMover mover;
    CHECK_FALSE(mover.holds());
    for (const Side side : {Side::left, Side::right}) {
      const auto& hand = frame.hands[flow::Placement::index_of(side)];
      for (const auto joint : {hand::Joint::wrist, hand::Joint::index_tip}) {
        mover.take(camera, frame, pixel_of(camera, hand.pose[joint].translation()), size);
        REQUIRE(mover.holds());
        CHECK(mover.move().side == side);
        CHECK((place_of(mover.move()) - hand.T_stage_wrist.translation()).norm() < 1e-12);
      }
    }
    mover.release();
    CHECK_FALSE(mover.holds());
    mover.take(camera, frame, Vector2d(-2000.0, -2000.0), size);
    CHECK_FALSE(mover.holds());
    flow::Frame empty = frame;
    for (auto& hand : empty.hands)
      hand.present = false;
    mover.take(camera, empty, pixel_of(camera, frame.hands[0].T_stage_wrist.translation()), size);
    CHECK_FALSE(mover.holds());
  }

  TEST_CASE("the wrist stays under the pointer, and at its depth") {
    test::LoopUnderTest test(flow::Mode::type1);
    const flow::Frame& frame = test.frame_after_tick(0);
    const Camera camera = looking_at(frame);
    const Vector3d wrist = frame.hands[0].T_stage_wrist.translation();
    const Vector2d begin = pixel_of(camera, wrist);
    HandMover mover;
    mover.take(camera, frame, begin, size);
    for (int step = 0; step < 10; ++step)
      mover.shift(camera, 7.0, -4.0, size.height);
    const Vector3d moved = place_of(mover.move());
    CHECK((pixel_of(camera, moved) - begin - Vector2d(70.0, -40.0)).norm() < 1e-6);
    CHECK(std::abs(camera.axes().row(2).dot(moved - wrist)) < 1e-12);
    CHECK((moved - wrist).norm() > 0.01);
  }

  TEST_CASE("the wheel pushes it away, and shift turns it where it is") {
    test::LoopUnderTest test(flow::Mode::type1);
    const flow::Frame& frame = test.frame_after_tick(0);
    const Camera camera = looking_at(frame);
    const Eigen::Isometry3d wrist = frame.hands[0].T_stage_wrist;
    HandMover mover;
    mover.take(camera, frame, pixel_of(camera, wrist.translation()), size);
    mover.push(camera, 3.0);
    const Vector3d pushed = place_of(mover.move());
    CHECK((pushed - wrist.translation() + 0.03 * camera.axes().row(2).transpose()).norm() < 1e-12);
    mover.turn(camera, 100.0, 0.0);
    CHECK((place_of(mover.move()) - pushed).norm() < 1e-12);
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(mover.move().pose().linear() * wrist.linear().transpose()));
    CHECK(turn.angle() == doctest::Approx(from_degrees(35.0)));
    CHECK(std::abs(turn.axis().dot(camera.axes().row(1).transpose())) == doctest::Approx(1.0));
  }

  TEST_CASE("beside a model that is not in the stage's middle a hand moves as anywhere") {
    test::LoopUnderTest test(flow::Mode::type1);
    flow::Frame frame = test.frame_after_tick(0);
    const Vector3d away(0.0, 3.2, -3.2);
    for (auto& joint : frame.hands[0].pose.joints)
      joint.translation() += away;
    frame.hands[0].T_stage_wrist.translation() += away;
    const Camera camera = looking_at(frame);
    const Vector3d wrist = frame.hands[0].T_stage_wrist.translation();
    HandMover mover;
    mover.take(camera, frame, pixel_of(camera, wrist), size);
    mover.push(camera, 3.0);
    CHECK((place_of(mover.move()) - wrist).norm() == doctest::Approx(0.03));
    mover.push(camera, 1e6);
    CHECK((place_of(mover.move()) - wrist).norm() <= 2.0 * std::sqrt(3.0) + 1e-9);
  }

  TEST_CASE("however wildly the mouse moves, the move is usable") {
    test::LoopUnderTest test(flow::Mode::type1);
    const flow::Frame& frame = test.frame_after_tick(0);
    const Camera camera = looking_at(frame);
    HandMover mover;
    mover.take(camera, frame, pixel_of(camera, frame.hands[0].T_stage_wrist.translation()), size);
    for (const double wild : {1e9, -1e12, 1e5}) {
      mover.shift(camera, wild, wild, 0.0);
      mover.push(camera, wild);
      mover.turn(camera, wild, -wild);
      CHECK(mover.move().is_usable());
    }
  }
}

} // namespace hand_mover_test
