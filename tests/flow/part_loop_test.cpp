// Hands that take parts of a model, in a loop.

#include <algorithm>
#include <memory>

#include <doctest/doctest.h>

#include "support/pinching_sample.hpp"
#include "support/restraint.hpp"

namespace part_loop_test {

using namespace nendo;
using namespace nendo::flow;
using namespace std::chrono_literals;
using deform::Points;
using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/// A ball, and a right hand whose thumb and index finger are at it, above it. The left hand is
/// away.
class Holding {
public:
  Holding() {
    test_.placement.T_stage_wrist[0].translation().y() += 5.0;
    const Vector3d top(0.0, 1.0 / test_.placement.units_per_metre, 0.0);
    at_top_ = test::wrist_pinching_at(Side::right, top);
    test_.placement.T_stage_wrist[1] = at_top_;
    test_.loop =
        std::make_unique<DeformLoop>(test_.model, test_.placement, test_.inputs, test_.options);
    go(false);
  }

  test::LoopUnderTest& test() noexcept { return test_; }
  /// Some ticks with an open or a closed hand, long enough for a gate to let it through.
  const Frame& go(bool closed, int ticks = 5) {
    for (int tick = 0; tick < ticks; ++tick) {
      now_ += 10ms;
      test_.rings[0]->try_push(test::bent_sample(Side::left, 0, now_));
      test_.rings[1]->try_push(closed ? test::pinching_sample(Side::right, now_)
                                      : test::bent_sample(Side::right, 0, now_));
      test_.loop->tick(ticks_++, now_, now_);
      test_.loop->frames().update();
    }
    return frame();
  }
  /// Moves the hand by so much from where it took the ball; on the stage.
  const Frame& carry(const Isometry3d& motion, bool closed = true) {
    test_.commands.try_push(WristMove::to(Side::right, motion * at_top_));
    return go(closed);
  }
  const Frame& ask(Request request, bool closed) {
    test_.commands.try_push(request);
    return go(closed);
  }
  const Frame& frame() { return test_.loop->frames().front(); }
  Points shape() { return test_.vertices_of(frame()); }
  /// How far vertices are from where a motion on the stage takes them.
  double off(const Isometry3d& motion) {
    const double units = test_.placement.units_per_metre;
    const Points now = shape();
    double worst = 0.0;
    for (Eigen::Index at = 0; at < now.cols(); ++at)
      worst = std::max(
          worst, (now.col(at) - units * (motion * (test_.model.vertices.col(at) / units))).norm());
    return worst;
  }
  void change_to(Mode mode) {
    LoopSettings settings = test_.loop->changes().settings();
    settings.mode = mode;
    REQUIRE(test_.loop->changes().change_settings(settings));
  }

private:
  test::LoopUnderTest test_{Mode::parts, {.rings_of_ball = 16}};
  Isometry3d at_top_ = Isometry3d::Identity();
  HostTime now_ = HostClock::now();
  std::uint64_t ticks_ = 0;
};

Isometry3d any_motion() {
  return Eigen::Translation3d(0.1, 0.05, -0.08) *
         AngleAxisd(0.7, Vector3d(1.0, 2.0, 0.5).normalized()) * Isometry3d::Identity();
}

constexpr double rounding = 1e-5; // of floats

} // namespace

TEST_SUITE("part_loop") {
  TEST_CASE(
      "a hand that pinches takes the part there, and carries and turns it as its wrist goes") {
    Holding hands;
    CHECK(hands.frame().parts.count == 1);
    CHECK_FALSE(hands.frame().parts.is_held());
    CHECK(hands.frame().contacts.count == 0);
    CHECK(hands.shape() == hands.test().model.vertices);
    const Frame& taken = hands.go(true);
    CHECK(taken.parts.held[0] == deform::no_index); // the other hand is away
    REQUIRE(taken.parts.held[1] == 0);
    CHECK(taken.contacts.count > 0);
    for (const deform::ClayContact& contact : taken.contacts.all()) {
      CHECK(contact.body == 1);
      CHECK((contact.place - Vector3d::UnitY()).norm() <
            (PartHands::reach_m + 0.02) * hands.test().placement.units_per_metre);
    }
    const HandTouch touch = touch_of(taken.contacts.all(), 1);
    CHECK(touch[0] > 0.0F); // thumb and index finger alone
    CHECK(touch[1] > 0.0F);
    CHECK(touch[2] + touch[3] + touch[4] + touch[5] == 0.0F);
    const Frame& carried = hands.carry(any_motion());
    CHECK(hands.off(any_motion()) < rounding);
    CHECK(carried.fields.fields().empty()); // fields describe nothing
    CHECK_FALSE(carried.clay.is_clay);
  }

  TEST_CASE("from taking to putting down is one step, undone and done again to the same bits") {
    Holding hands;
    hands.go(true);
    hands.carry(Isometry3d(Eigen::Translation3d(0.0, 0.1, 0.0)));
    hands.carry(any_motion());
    CHECK(hands.frame().steps.in_hand);
    const Frame& put_down = hands.carry(any_motion(), false);
    CHECK_FALSE(put_down.parts.is_held());
    CHECK(put_down.undo_steps == 1);
    CHECK_FALSE(put_down.steps.in_hand);
    const Points there = hands.shape();
    hands.carry(Isometry3d::Identity(), false); // an empty hand moves nothing
    CHECK(hands.shape() == there);
    CHECK(hands.frame().undo_steps == 1);
    hands.ask(Request::undo, false);
    CHECK(hands.shape() == hands.test().model.vertices);
    hands.ask(Request::redo, false);
    CHECK(hands.shape() == there);
    hands.ask(Request::reset, false);
    CHECK(hands.shape() == hands.test().model.vertices);
  }

  TEST_CASE("an undo takes a part out of the hand, which holds it on from there") {
    Holding hands;
    hands.go(true);
    hands.carry(any_motion());
    hands.ask(Request::undo, true);
    CHECK(hands.shape() == hands.test().model.vertices);
    CHECK(hands.frame().parts.held[1] == 0);
    const Isometry3d more(Eigen::Translation3d(0.0, 0.2, 0.0));
    hands.carry(more * any_motion());
    CHECK(hands.off(more) < rounding);
  }

  TEST_CASE("other settings put it down where it is, and it can be pulled from there") {
    Holding hands;
    hands.go(true);
    hands.carry(any_motion());
    hands.change_to(Mode::type1);
    const Frame& pulled = hands.go(true);
    CHECK(pulled.parts.count == 0);
    CHECK(hands.off(any_motion()) < rounding);
    hands.change_to(Mode::parts);
    hands.go(true);
    CHECK(hands.frame().parts.count == 1);
    CHECK(hands.off(any_motion()) < rounding);
    CHECK(hands.frame().undo_steps >= 1);
  }

  TEST_CASE("no tick allocates, frees or locks, when hands take parts and when they carry them") {
    Holding hands;
    const GloveSample open = test::bent_sample(Side::right, 0, HostClock::now());
    GloveSample closed = test::pinching_sample(Side::right, HostClock::now());
    test::RestraintCounts counts;
    std::uint64_t held = 0;
    {
      const test::Restraint restraint;
      for (std::uint64_t tick = 100; tick < 500; ++tick) {
        hands.test().rings[1]->try_push(tick % 20 < 10 ? closed : open);
        hands.test().loop->tick(tick, HostClock::now(), HostClock::now());
        hands.test().loop->frames().update();
        held += hands.frame().parts.is_held() ? 1U : 0U;
      }
      counts = restraint.counts();
    }
    CHECK(held > 100);
    CHECK(held < 300);
    CHECK(counts.allocations == 0);
    CHECK(counts.frees == 0);
    CHECK(counts.locks == 0);
  }
}

} // namespace part_loop_test
