// The whole hand holds the model in type 1: points all over it, live, and without a stop.

#include <algorithm>
#include <chrono>
#include <cmath>

#include <doctest/doctest.h>

#include <nendo/hand/held_points.hpp>

#include "support/flow_fixtures.hpp"
#include "support/late_maker.hpp"
#include "support/restraint.hpp"

namespace hold_test {

using namespace nendo;
using flow::Hold;
using flow::Mode;

namespace {

constexpr auto per_hand = static_cast<Eigen::Index>(hand::held_point_count);

/// A loop in which the whole hands hold the model.
struct HeldLoop : test::LoopUnderTest {
  explicit HeldLoop(double keep_volume = 0.0, bool injective = false,
                    const test::LoopFixture& fixture = {})
      : LoopUnderTest(Mode::type1, fixture) {
    options.sculptor.hold = Hold::hand;
    options.sculptor.deformer.csrbf.keep_volume = keep_volume;
    if (injective) options.sculptor.deformer.injective.emplace();
    loop = std::make_unique<flow::DeformLoop>(model, placement, inputs, options);
  }
};

deform::Points places_of(const flow::Frame& frame) {
  deform::Points places(3, 2 * per_hand);
  for (int slot = 0; slot < 2; ++slot)
    places.middleCols(slot * per_hand, per_hand) =
        frame.units_per_metre * hand::held_places(frame.hands[static_cast<std::size_t>(slot)].pose);
  return places;
}

} // namespace

TEST_SUITE("hold") {
  TEST_CASE("the points are all over an open hand, and no two of a finger are together") {
    const hand::HandPose pose =
        hand::HandSkeleton(Side::right).pose({}, Eigen::Isometry3d::Identity());
    const hand::HeldPlaces places = hand::held_places(pose);
    std::array<int, 5> of_fingers{};
    for (const hand::HeldPoint& point : hand::held_points)
      ++of_fingers[point.finger];
    CHECK(*std::min_element(of_fingers.begin(), of_fingers.end()) >= 7);
    for (Eigen::Index a = 0; a < per_hand; ++a)
      for (Eigen::Index b = a + 1; b < per_hand; ++b)
        CHECK((places.col(a) - places.col(b)).norm() > 0.009);
    // Each joint but palm and the roots of the palm is one of them, and so is each fingertip.
    const auto tips = pose.fingertip_positions();
    for (Eigen::Index tip = 0; tip < 5; ++tip)
      CHECK((places.colwise() - tips.col(tip)).colwise().norm().minCoeff() < 1e-12);
  }

  TEST_CASE("the model follows all of the hand, and what it does not need to follow exactly") {
    for (const bool injective : {false, true}) {
      CAPTURE(injective);
      HeldLoop test(0.0, injective);
      const flow::Frame& first = test.frame_after_tick(0);
      const deform::Points starts = places_of(first);
      const HostTime now = HostClock::now();
      test.bend(injective ? 4 : 15, now);
      const flow::Frame& frame = test.frame_after_tick(1);
      REQUIRE(is_solved(frame.status));
      REQUIRE(frame.fields.fields().size() >= 1);
      CHECK(frame.fields.fields().front().centres.cols() == 2 * per_hand);
      const deform::Points ends = places_of(frame);
      deform::Points moved;
      deform::displace(frame.fields.fields(), starts, moved);
      const double way = (ends - starts).colwise().norm().maxCoeff();
      CHECK(way > 1e-3);
      CHECK((moved - ends).colwise().norm().maxCoeff() < 0.05 * way);
      deform::Points shape;
      deform::displace(frame.fields.fields(), test.model.vertices, shape);
      CHECK((test.vertices_of(frame) - shape).cwiseAbs().maxCoeff() <
            1e-5 * deform::diagonal_of(test.model.vertices));
    }
  }

  TEST_CASE("with clay, or strokes, or a puppet, the hand's own points do not hold") {
    HeldLoop clay(1.0);
    clay.bend(15, HostClock::now());
    CHECK(clay.frame_after_tick(1).fields.fields().front().centres.cols() == 10);
    HeldLoop puppet(0.0, false, {.puppet = test::ball_puppet});
    CHECK(is_solved(puppet.loop->grab_status()));
    for (std::uint64_t tick = 1; tick <= 20; ++tick) {
      puppet.bend(static_cast<int>(10 * tick), HostClock::now());
      const flow::Frame& frame = puppet.frame_after_tick(tick);
      CHECK(is_solved(frame.status));
      for (const deform::CsrbfField& field : frame.fields.fields())
        CHECK(field.centres.cols() == puppet.options.sculptor.deformer.supports.functions(
                                          puppet.options.rig->starts().cols()));
    }
  }

  TEST_CASE("it comes and goes while the loop runs, as a step, and a tick does not allocate") {
    test::LoopUnderTest test(Mode::type1);
    std::uint64_t tick = 0;
    const auto go_on = [&](int ticks) -> const flow::Frame& {
      nendo::test::RestraintCounts counts;
      for (int end = ticks; end > 0; --end) {
        test.bend(static_cast<int>(tick % 12), HostClock::now());
        const nendo::test::Restraint restraint;
        test.loop->tick(tick++, HostClock::now());
        counts = restraint.counts();
        CHECK(counts.allocations == 0);
        CHECK(counts.locks == 0);
      }
      test.loop->frames().update();
      return test.loop->frames().front();
    };
    go_on(5);
    flow::LoopSettings settings = go_on(1).settings;
    for (const auto& [hold, keep] : {std::pair{Hold::hand, 0.0},
                                     {Hold::hand, 0.5},
                                     {Hold::hand, 0.0},
                                     {Hold::fingertips, 1.0}}) {
      settings.hold = hold;
      settings.keep_volume = keep;
      const deform::Points before = test.vertices_of(go_on(1));
      REQUIRE(test.loop->changes().change_settings(settings));
      const flow::Frame& taken = go_on(1);
      CHECK(taken.shape.block_count() > 0);
      while (test.loop->changes().is_changing())
        go_on(1);
      const flow::Frame& frame = go_on(6);
      CHECK(frame.settings == settings);
      CHECK(is_solved(frame.status));
      const bool all_over = hold == Hold::hand && keep == 0.0;
      CHECK(frame.fields.fields().front().centres.cols() == (all_over ? 2 * per_hand : 10));
      CHECK((test.vertices_of(frame) - before).cwiseAbs().maxCoeff() > 0.0);
    }
    CHECK(go_on(1).undo_steps > 0);
  }
}

} // namespace hold_test
