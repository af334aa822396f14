#include <nendo/flow/deform_loop.hpp>

#include <chrono>

#include <doctest/doctest.h>

#include <nendo/hand/angle.hpp>

#include "support/flow_fixtures.hpp"
#include "support/restraint.hpp"

namespace tracked_wrist_test {

using namespace nendo;
using namespace nendo::flow;
using namespace std::chrono_literals;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

constexpr auto period = 4ms; // 250 Hz

/// A loop whose ticks are due every 4 ms, by a clock of the test's, with a pose of each hand before
/// each tick.
struct Tracked {
  test::LoopUnderTest test;
  HostTime now = HostClock::now();
  std::uint64_t ticks = 0;

  explicit Tracked(Mode mode = Mode::type1)
      : test(mode, {.rings_of_ball = 16, .rate_hz = 250.0, .tracked = true}) {}

  void push(Side side, const Vector3d& position_m) {
    PoseSample pose;
    pose.arrival = pose.measured = now;
    pose.sequence = ticks;
    pose.position_m = {position_m.x(), position_m.y(), position_m.z()};
    test.poses[Placement::index_of(side)]->try_push(pose);
  }
  const Frame& tick() {
    test.bend(0, now);
    test.loop->tick(ticks++, now, now);
    now += period;
    test.loop->frames().update();
    return test.loop->frames().front();
  }
  /// Both stations go to that place at 0.5 m/s.
  const Frame& go(const Vector3d& from, const Vector3d& to) {
    const int steps = std::max(1, static_cast<int>((to - from).norm() / 0.002));
    for (int step = 1; step <= steps; ++step) {
      const Vector3d at = from + (to - from) * step / steps;
      push(Side::left, at);
      push(Side::right, at);
      tick();
    }
    return test.loop->frames().front();
  }
  Vector3d moved(std::size_t hand) const {
    return test.loop->frames().front().hands[hand].T_stage_wrist.translation() -
           test.placement.T_stage_wrist[hand].translation();
  }
};

} // namespace

TEST_SUITE("tracked_wrist") {
  TEST_CASE("a hand begins where it was placed, and follows its station and shapes") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      Tracked hands(mode);
      const Vector3d begin(1.0, 2.0, -0.5);
      hands.go(begin, begin);
      CHECK(hands.moved(0).norm() < 1e-9);
      const Frame& frame = hands.go(begin, begin + Vector3d(0.0, 0.05, 0.0));
      for (const std::size_t hand : {0U, 1U}) {
        CHECK(frame.hands[hand].tracked);
        CHECK_FALSE(frame.hands[hand].lost);
        CHECK(std::abs(hands.moved(hand).norm() - 0.05) < 1e-9);
      }
      CHECK((hands.test.vertices_of(frame) - hands.test.model.vertices).cwiseAbs().maxCoeff() >
            1e-3);
      CHECK(hands.test.loop->stats().wrists[0].counts.poses > 20);
      CHECK(hands.test.loop->stats().pose_age.count() > 20);
    }
  }

  TEST_CASE("a frame has the poses of each wrist, and when the newest sample and good pose came") {
    Tracked hands;
    CHECK(hands.tick().hands[0].newest_pose == HostTime{});
    const Vector3d begin(0.5, 0.0, 0.0);
    hands.go(begin, begin + Vector3d(0.0, 0.02, 0.0));
    const HostTime good = hands.now - period;
    CHECK(hands.test.loop->frames().front().hands[0].newest_pose == good);
    for (int pose = 0; pose < 3; ++pose) {
      hands.push(Side::left, begin + Vector3d(1.0 + pose, 0.0, 0.0)); // where no hand can be
      hands.tick();
    }
    const Frame& frame = hands.test.loop->frames().front();
    const auto& [left, right] = frame.hands;
    CHECK(left.newest_pose == good);
    CHECK(left.pose_counts.refused == 3);
    CHECK(left.pose_counts.poses == right.pose_counts.poses + 3);
    CHECK(right.pose_counts.refused == 0);
    for (const HandFrame& hand : frame.hands)
      CHECK(hand.newest_sample == hands.now - period);
  }

  TEST_CASE("a lost hand freezes within 0.1 s and a tick, and one that returns nearby keeps hold") {
    Tracked hands;
    const Vector3d begin(0.5, 0.0, 0.0);
    hands.go(begin, begin);
    hands.go(begin, begin + Vector3d(0.0, 0.02, 0.0));
    const Vector3d before = hands.moved(0);
    int ticks = 0;
    while (!hands.tick().hands[0].lost)
      ++ticks;
    CHECK(ticks * period <= 100ms + period);
    CHECK((hands.moved(0) - before).norm() < 1e-9);
    CHECK(hands.test.loop->stats().wrists[0].counts.losses == 1);
    const Vector3d back = begin + Vector3d(0.0, 0.12, 0.0);
    for (int tick = 0; tick < 200; ++tick)
      hands.go(back, back);
    CHECK(hands.test.loop->frames().front().held);
    CHECK(hands.test.loop->stats().wrists[0].releases == 0);
    CHECK(std::abs(hands.moved(0).norm() - 0.12) < 1e-6);
  }

  TEST_CASE("a hand that returns far away releases the model where it was lost") {
    Tracked hands(Mode::type2), control(Mode::type2);
    const Vector3d begin(0.5, 0.0, 0.0), far = begin + Vector3d(0.0, 0.35, 0.0);
    for (Tracked* one : {&hands, &control}) {
      one->go(begin, begin);
      one->go(begin, begin + Vector3d(0.0, 0.05, 0.0));
      for (int tick = 0; tick < 100; ++tick)
        one->tick();
      CHECK(one->test.loop->frames().front().hands[0].lost);
    }
    control.test.commands.try_push(Request::release);
    for (int tick = 0; tick < 100; ++tick) {
      hands.go(far, far);
      control.tick();
    }
    const Frame& frame = hands.test.loop->frames().front();
    CHECK_FALSE(frame.held);
    CHECK(hands.test.loop->stats().wrists[0].releases == 1);
    CHECK(std::abs(hands.moved(0).norm() - 0.35) < 1e-6);
    const bool is_same = hands.test.vertices_of(frame) ==
                         control.test.vertices_of(control.test.loop->frames().front());
    CHECK(is_same);
  }

  TEST_CASE("a key moves the hands back, and a mouse moves the frame that they follow") {
    Tracked hands;
    const Vector3d begin(0.5, 0.0, 0.0), up(0.0, 0.05, 0.0);
    hands.go(begin, begin + up);
    REQUIRE(hands.test.commands.try_push(Recentre{}));
    hands.go(begin + up, begin + up);
    CHECK(hands.moved(0).norm() < 1e-9);
    CHECK(hands.moved(1).norm() < 1e-9);
    Isometry3d wrist = hands.test.placement.T_stage_wrist[0];
    wrist.pretranslate(Vector3d(0.1, 0.2, 0.0));
    REQUIRE(hands.test.commands.try_push(WristMove::to(Side::left, wrist)));
    hands.go(begin + up, begin + up);
    CHECK((hands.moved(0) - Vector3d(0.1, 0.2, 0.0)).norm() < 1e-9);
    hands.go(begin + up, begin + up + up);
    CHECK(std::abs((hands.moved(0) - Vector3d(0.1, 0.2, 0.0)).norm() - 0.05) < 1e-9);
  }

  TEST_CASE(
      "a recording that begins in the middle leaves the hands where they are, and their counts") {
    Tracked hands;
    const Vector3d begin(0.5, 0.0, 0.0), up(0.0, 0.05, 0.0);
    hands.go(begin, begin);
    hands.go(begin, begin + up);
    const Vector3d before = hands.moved(0);
    const auto counted = hands.test.loop->stats().wrists[0].counts.poses;
    InputLog log;
    hands.test.loop->changes().change_log(&log, hands.test.loop->frames().front().shape);
    hands.go(begin + up, begin + up);
    hands.go(begin + up, begin + up);
    CHECK((hands.moved(0) - before).norm() < 1e-9);
    CHECK(hands.test.loop->stats().wrists[0].counts.poses == counted + 2);
    hands.go(begin + up, begin + up + up);
    CHECK((hands.moved(0) - 2.0 * before).norm() < 1e-9);
  }

  TEST_CASE("a station on the back of the hand leaves no turn to the wrist's sensors") {
    test::LoopUnderTest test(Mode::type1, {.rings_of_ball = 16, .gated = false, .tracked = true});
    std::vector<HandInput> inputs = test.inputs;
    inputs[0].wrist_source->tracking.mount.on_hand = true;
    DeformLoop loop(test.model, test.placement, inputs, test.options);
    const HostTime now = HostClock::now();
    for (const Side side : {Side::left, Side::right}) {
      GloveSample sample = test::bent_sample(side, 0, now);
      sample.raw[index_of(Sensor::wrist_pitch)].value += 40;
      test.rings[Placement::index_of(side)]->try_push(sample);
    }
    loop.tick(0, now, now);
    REQUIRE(loop.frames().update());
    const Frame& frame = loop.frames().front();
    CHECK(frame.hands[0].angles[hand::Angle::wrist_pitch] == 0.0);
    CHECK(std::abs(frame.hands[1].angles[hand::Angle::wrist_pitch]) > 0.1);
  }

  TEST_CASE("ticks with two trackers allocate nothing and take no lock") {
    Tracked hands(Mode::type2);
    const Vector3d begin(0.5, 0.0, 0.0);
    hands.go(begin, begin);
    test::RestraintCounts counts;
    {
      const test::Restraint restraint;
      hands.go(begin, begin + Vector3d(0.0, 0.1, 0.0));
      for (int tick = 0; tick < 100; ++tick)
        hands.tick(); // lost
      hands.go(begin + Vector3d(0.0, 0.2, 0.0), begin);
      counts = restraint.counts();
    }
    CHECK(counts.allocations + counts.frees + counts.locks == 0);
    CHECK(hands.test.loop->stats().wrists[1].counts.losses == 1);
  }
}

} // namespace tracked_wrist_test
