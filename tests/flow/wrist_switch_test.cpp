#include <nendo/flow/wrist.hpp>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"
#include "support/restraint.hpp"

namespace wrist_switch_test {

using namespace nendo;
using namespace nendo::flow;
using nendo::test::LoopUnderTest;
using namespace std::chrono_literals;

namespace {

/// Both hands' gloves, sample by sample at 90 Hz, and a tick of the loop for each.
struct Sculptors {
  LoopUnderTest test;
  HostTime now = HostClock::now();
  std::uint64_t tick = 0;

  Sculptors(Mode mode, SwitchAction action) : test(mode, {.switch_action = action}) {}

  const Frame& step(int counts, WristSwitch left, WristSwitch right = WristSwitch::unknown) {
    now += 11ms;
    for (const Side side : {Side::left, Side::right}) {
      GloveSample sample = test::bent_sample(side, counts, now);
      sample.wrist_switch = side == Side::left ? left : right;
      test.rings[Placement::index_of(side)]->try_push(sample);
    }
    return test.frame_after_tick(tick++);
  }
  /// The fingers go from `from` to `to` counts, the switch stays as it is.
  const Frame& move(int from, int to, WristSwitch position) {
    const int step_counts = from < to ? 1 : -1;
    for (int at = from; at != to; at += step_counts)
      step(at, position);
    for (int n = 0; n < 5; ++n) // and stay, until a turned switch has settled
      step(to, position);
    return test.loop->frames().front();
  }
};

constexpr auto on = WristSwitch::on;
constexpr auto off = WristSwitch::off;

} // namespace

TEST_SUITE("wrist_switch") {
  TEST_CASE("actions have names") {
    for (const auto action : {SwitchAction::none, SwitchAction::grab, SwitchAction::commit,
                              SwitchAction::toggle, SwitchAction::keep}) {
      CHECK(switch_action_named(name_of(action)) == action);
    }
    CHECK_FALSE(switch_action_named("press").has_value());
    CHECK_FALSE(switch_action_named("").has_value());
  }

  TEST_CASE("a switch that is turned on and stays on is one event, at any rate") {
    for (const auto period : {1ms, 11ms, 200ms}) {
      WristSwitchEdge edge;
      HostTime now{1h};
      int events = 0;
      const auto hold = [&](WristSwitch position, std::chrono::milliseconds time) {
        for (const HostTime end = now + time; now < end; now += period)
          events += edge.turned_on(position, now) ? 1 : 0;
      };
      for (int round = 1; round <= 3; ++round) {
        hold(off, 1s);
        CHECK_FALSE(edge.is_on());
        hold(on, 1s);
        CHECK(edge.is_on());
        CHECK(events == round);
      }
    }
  }

  TEST_CASE("bouncing contacts and a damaged status byte are no event") {
    WristSwitchEdge edge;
    HostTime now{1h};
    edge.turned_on(off, now);
    for (int n = 0; n < 500; ++n) { // never 20 ms in one place
      now += 5ms;
      CHECK_FALSE(edge.turned_on(n % 4 == 3 ? off : on, now));
    }
    edge.turned_on(off, now += 100ms);
    CHECK_FALSE(edge.turned_on(on, now += 300ms)); // one sample of a slow glove
    CHECK_FALSE(edge.turned_on(off, now += 300ms));
    CHECK_FALSE(edge.is_on());
  }

  TEST_CASE("a switch that is on from the start was not turned on, and silence about it is no "
            "news") {
    WristSwitchEdge edge;
    HostTime now{1h};
    CHECK_FALSE(edge.turned_on(WristSwitch::unknown, now));
    CHECK_FALSE(edge.is_on());
    for (int n = 0; n < 10; ++n)
      CHECK_FALSE(edge.turned_on(on, now += 11ms));
    CHECK(edge.is_on());
    for (int n = 0; n < 10; ++n)
      edge.turned_on(WristSwitch::unknown, now += 11ms);
    CHECK(edge.is_on());
  }

  TEST_CASE("grab: the model is shaped while the switch is on, and keeps its shape afterwards") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      Sculptors hands(mode, SwitchAction::grab);
      const Frame& free = hands.move(0, 15, off);
      CHECK_FALSE(free.held);
      CHECK(hands.test.vertices_of(free) == hands.test.model.vertices);
      hands.move(15, 5, off);
      CHECK(hands.move(5, 5, on).held);
      const deform::Points before = hands.test.vertices_of(hands.test.loop->frames().front());
      CHECK((before - hands.test.model.vertices).cwiseAbs().maxCoeff() < test::float_gap);
      const deform::Points shaped = hands.test.vertices_of(hands.move(5, 20, on));
      CHECK((shaped - before).cwiseAbs().maxCoeff() > 0.02);
      CHECK_FALSE(hands.move(20, 20, off).held);
      const deform::Points kept = hands.test.vertices_of(hands.test.loop->frames().front());
      const double piece = 0.02; // what a stroke of type 2 may still have waiting
      CHECK((kept - shaped).cwiseAbs().maxCoeff() < (mode == Mode::type1 ? 1e-9 : piece));
      CHECK(hands.test.vertices_of(hands.move(20, 0, off)) == kept);
      CHECK(hands.test.loop->final_shape() == kept);
      CHECK(hands.test.loop->stats().grabs == 1);
      CHECK(hands.test.loop->stats().switch_uses[0] == 1);
      CHECK(hands.test.loop->stats().switch_uses[1] == 0);
    }
  }

  TEST_CASE("commit: what was shaped stays when the fingers go back") {
    for (const auto action : {SwitchAction::none, SwitchAction::commit}) {
      Sculptors hands(Mode::type1, action);
      hands.move(0, 15, off);
      const deform::Points shaped = hands.test.vertices_of(hands.move(15, 15, on));
      CHECK(hands.test.loop->frames().front().held);
      const deform::Points back = hands.test.vertices_of(hands.move(15, 0, off));
      const double left_over = (back - hands.test.model.vertices).cwiseAbs().maxCoeff();
      const bool commits = action == SwitchAction::commit;
      CHECK(hands.test.loop->stats().commits == (commits ? 1 : 0));
      CHECK(hands.test.loop->frames().front().commits == (commits ? 1 : 0));
      CHECK((left_over > 1e-3) == commits);
      CHECK(hands.test.loop->stats().failed == 0);
    }
  }

  TEST_CASE("a copy of the model that follows fields and changes of the rest shape stays the same "
            "as the model") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      Sculptors hands(mode, SwitchAction::commit);
      deform::Points rest = hands.test.model.vertices;
      deform::Points copy = rest;
      std::uint64_t rest_changes = 0;
      for (int n = 0; n < 80; ++n) {
        const Frame& frame = hands.step(n % 20, n / 10 % 2 == 1 ? on : off);
        if (mode == Mode::type1) copy = rest;
        for (const auto& field : frame.fields.fields())
          deform::displace(field, copy, copy);
        REQUIRE((copy - hands.test.vertices_of(frame)).cwiseAbs().maxCoeff() < test::float_gap);
        if (frame.rest_changes != rest_changes) rest = copy;
        rest_changes = frame.rest_changes;
      }
      CHECK(rest_changes == 4);
    }
  }

  TEST_CASE("toggle: the switch releases the model, and grabs it when used again") {
    Sculptors hands(Mode::type1, SwitchAction::toggle);
    CHECK(hands.move(0, 10, off).held);
    CHECK_FALSE(hands.move(10, 10, on).held);
    const deform::Points kept = hands.test.vertices_of(hands.test.loop->frames().front());
    CHECK_FALSE(hands.move(10, 0, off).held); // letting the switch go is nothing
    CHECK(hands.test.vertices_of(hands.test.loop->frames().front()) == kept);
    CHECK(hands.move(0, 0, on).held);
    CHECK((hands.test.vertices_of(hands.move(0, 10, on)) - kept).cwiseAbs().maxCoeff() > 0.02);
    CHECK(hands.test.loop->stats().switch_uses[0] == 2);
  }

  TEST_CASE("either hand's switch will do, and a glove that has none does not matter") {
    Sculptors hands(Mode::type1, SwitchAction::grab);
    for (int n = 0; n < 5; ++n)
      hands.step(0, WristSwitch::unknown, on);
    CHECK(hands.test.loop->frames().front().held);
    for (int n = 0; n < 5; ++n)
      hands.step(0, off, off);
    CHECK_FALSE(hands.test.loop->frames().front().held);
  }

  TEST_CASE("grabbing, committing and releasing allocate nothing and take no lock") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      for (const auto action : {SwitchAction::grab, SwitchAction::commit, SwitchAction::toggle}) {
        Sculptors hands(mode, action);
        test::RestraintCounts counts;
        {
          const test::Restraint restraint;
          for (int round = 0; round < 6; ++round)
            hands.move(round % 2 * 10, 10 - round % 2 * 10, round % 3 == 0 ? off : on);
          counts = restraint.counts();
        }
        CHECK(counts.allocations + counts.frees + counts.locks == 0);
        CHECK(hands.test.loop->stats().switch_uses[0] == 2);
        CHECK(hands.test.loop->stats().failed == 0);
      }
    }
  }
}

} // namespace wrist_switch_test
