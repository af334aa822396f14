#pragma once
// A loop that a test drives tick by tick, by a clock that it sets itself.

#include <vector>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"

namespace nendo::test {

/// Returns the greatest difference of a coordinate.
inline double gap(const deform::Points& a, const deform::Points& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

/// A loop over a ball, with ticks of that clock.
struct Clocked {
  LoopUnderTest test;
  HostTime now = HostClock::now();
  std::uint64_t number = 0;

  explicit Clocked(flow::Mode mode, const LoopFixture& fixture = {.rings_of_ball = 12})
      : test(mode, fixture) {}

  deform::Points tick(HostClock::duration later = std::chrono::milliseconds(1)) {
    now += later;
    test.loop->tick(number++, now, now);
    test.loop->frames().update();
    return test.vertices_of(frame());
  }
  /// Asks for it, and ticks until it is done, as who runs the loop does.
  deform::Points step(flow::Request request) {
    const std::uint64_t before = frame().shape_jumps;
    REQUIRE(test.commands.try_push(request));
    deform::Points shape = tick();
    if (frame().awaited) {
      CHECK(frame().shape_jumps == before);
      REQUIRE(test.loop->changes().change_to(*frame().awaited));
      shape = tick();
      CHECK_FALSE(frame().awaited);
    }
    CHECK(frame().shape_jumps == before + 1);
    return shape;
  }
  std::vector<flow::StepKind> kinds() {
    std::vector<flow::StepKind> all;
    for (const flow::Step& step : frame().steps.all())
      all.push_back(step.kind);
    return all;
  }
  deform::Points bent(int counts, HostClock::duration later = std::chrono::milliseconds(11)) {
    test.bend(counts, now + later);
    return tick(later);
  }
  /// Bends the hands little by little, up to `counts`.
  deform::Points stroke(int from, int counts) {
    deform::Points shape;
    for (int at = from; at != counts; at += from < counts ? 1 : -1)
      shape = bent(at);
    return shape;
  }
  const flow::Frame& frame() { return test.loop->frames().front(); }
  void change(const flow::LoopSettings& settings) {
    REQUIRE(test.loop->changes().change_settings(settings));
  }
};

} // namespace nendo::test
