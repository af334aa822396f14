// A loop that plays a puppet.

#include <algorithm>
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"
#include "support/restraint.hpp"

namespace rig_loop_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::flow;
using test::LoopUnderTest;

namespace {

LoopUnderTest puppet_loop(Mode mode = Mode::type1) {
  return LoopUnderTest(mode, {.puppet = test::ball_puppet});
}

} // namespace

TEST_SUITE("rig_loop") {
  TEST_CASE("relaxed hands leave the model as it is, bit for bit, and bent ones move it") {
    auto test = puppet_loop();
    CHECK(test.loop->grab_status() == deform::FieldStatus::ok);
    const HostTime now = HostClock::now();
    for (std::uint64_t tick = 0; tick < 10; ++tick) {
      test.bend(0, now + tick * 11ms);
      const Frame& frame = test.frame_after_tick(tick);
      CHECK(test.vertices_of(frame) == test.model.vertices);
      CHECK(frame.function_count == 4); // growRight is growLeft's twin
    }
    test.bend(25, now + 200ms);
    const Frame& bent = test.frame_after_tick(11);
    CHECK((test.vertices_of(bent) - test.model.vertices).cwiseAbs().maxCoeff() > 0.02);
    CHECK(bent.fields.fields().empty()); // which do not describe paths along a surface
    test.bend(0, now + 300ms);
    CHECK(
        (test.vertices_of(test.frame_after_tick(12)) - test.model.vertices).cwiseAbs().maxCoeff() <
        1e-6);
  }

  TEST_CASE("hands that release leave the shape, and grab again wherever they are then") {
    auto test = puppet_loop();
    HostTime now = HostClock::now();
    std::uint64_t tick = 0;
    const auto after = [&](int counts) {
      test.bend(counts, now += 11ms);
      return test.vertices_of(test.frame_after_tick(tick++));
    };
    after(0);
    const deform::Points bent = after(20);
    test.commands.try_push(Request::release);
    CHECK((after(20) - bent).cwiseAbs().maxCoeff() < 1e-6);
    CHECK((after(0) - bent).cwiseAbs().maxCoeff() < 1e-6); // as one lifts a mouse
    test.commands.try_push(Request::grab);
    CHECK((after(0) - bent).cwiseAbs().maxCoeff() < 1e-6);
    CHECK((after(10) - bent).cwiseAbs().maxCoeff() > 5e-3);
    CHECK((after(0) - bent).cwiseAbs().maxCoeff() < 1e-6);
  }

  TEST_CASE("a finger, or a hand, releases its functions while the others continue") {
    auto test = puppet_loop();
    HostTime now = HostClock::now();
    std::uint64_t tick = 0;
    const auto after = [&](int counts) {
      test.bend(counts, now += 11ms);
      const auto& functions = test.frame_after_tick(tick++).functions;
      return std::vector<double>(functions.begin(), functions.begin() + 4);
    };
    const auto& functions = test.options.rig->puppet().functions;
    after(0);
    const auto bent = after(12);
    test.commands.try_push(SetClutch{Side::right, 2, false}); // the middle finger
    const auto more = after(20);
    for (std::size_t at = 0; at < functions.size(); ++at)
      CHECK((more[at] == bent[at]) == (functions[at].name == "turn"));
    test.commands.try_push(SetClutch{Side::right, puppet::RigPlayer::all_fingers, false});
    const auto left_only = after(5);
    CHECK(test.loop->frames().front().released == std::array{false, true});
    for (std::size_t at = 0; at < functions.size(); ++at)
      CHECK((left_only[at] == more[at]) == (functions[at].input.side() == Side::right));
    test.commands.try_push(SetClutch{Side::right, puppet::RigPlayer::all_fingers, true});
    const auto again = after(5); // wherever the hand is, nothing leaps
    for (std::size_t at = 0; at < functions.size(); ++at)
      CHECK(again[at] == doctest::Approx(left_only[at]).epsilon(1e-6));
    CHECK(test.loop->frames().front().released == std::array{false, false});
  }

  TEST_CASE("one hand plays both sides, and a function listens to another finger") {
    auto test = puppet_loop();
    HostTime now = HostClock::now();
    const auto& functions = test.options.rig->puppet().functions;
    const auto number_of = [&](std::string_view name) {
      return static_cast<std::size_t>(
          std::find_if(functions.begin(), functions.end(),
                       [&](const auto& function) { return function.name == name; }) -
          functions.begin());
    };
    const std::size_t left = number_of("growLeft"), right = number_of("growRight");
    test.commands.try_push(SetSymmetry{true});
    test.frame_after_tick(0);
    test.rings[0]->try_push(test::bent_sample(Side::left, 15, now + 11ms));
    const Frame& both = test.frame_after_tick(1);
    CHECK(both.symmetric);
    CHECK(both.functions[left] > 0.1F);
    CHECK(both.functions[right] == both.functions[left]);
    test.commands.try_push(SetSymmetry{false});
    const auto role = puppet::HandSignal::named("right.thumb_flexion");
    REQUIRE(role);
    test.commands.try_push(SetRole{static_cast<std::uint16_t>(left), *role});
    const float before = test.frame_after_tick(2).functions[left];
    test.rings[0]->try_push(test::bent_sample(Side::left, 0, now + 33ms));
    CHECK(test.frame_after_tick(3).functions[left] == before);
    test.rings[1]->try_push(test::bent_sample(Side::right, 15, now + 44ms));
    CHECK(test.frame_after_tick(4).functions[left] > before);
    CHECK(test.loop->frames().front().functions[right] > 0.1F); // its own hand again
  }

  TEST_CASE("hands that grab again leave a puppet as it is, and continue from their present pose") {
    auto test = puppet_loop();
    HostTime now = HostClock::now();
    std::uint64_t tick = 0;
    const auto after = [&](int counts) {
      test.bend(counts, now += 11ms);
      return test.frame_after_tick(tick++).functions;
    };
    for (int counts = 0; counts < 60; counts += 4)
      after(counts);
    after(60);
    const auto far = after(60); // beyond its limits
    test.commands.try_push(Request::regrab);
    CHECK(after(60) == far);
    const auto back = after(50); // at once, and not only when it is within the limits again
    for (std::size_t at = 0; at < 4; ++at)
      CHECK(back[at] != far[at]);
  }

  TEST_CASE("a wrist switch that is a clutch lets its hand release and grab again, and no more") {
    const std::string text =
        std::string(test::ball_puppet) + "[clutch]\nleft = \"fist\"\nright = \"switch\"\n";
    LoopUnderTest test(Mode::type1,
                       {.switch_action = SwitchAction::commit, .puppet = text.c_str()});
    HostTime now = HostClock::now();
    std::uint64_t tick = 0;
    const auto after = [&](int counts, WristSwitch position) {
      for (int repeat = 0; repeat < 5; ++repeat) { // as long as a switch takes to settle
        GloveSample sample = test::bent_sample(Side::right, counts, now += 11ms);
        sample.wrist_switch = position;
        test.rings[1]->try_push(sample);
        test.frame_after_tick(tick++);
      }
      return test.loop->frames().front();
    };
    after(0, WristSwitch::off);
    const Frame bent = after(12, WristSwitch::off);
    const Frame free = after(12, WristSwitch::on);
    CHECK(free.released == std::array{false, true});
    CHECK(after(0, WristSwitch::off).functions == bent.functions);
    const Frame held = after(0, WristSwitch::on);
    CHECK(held.released == std::array{false, false});
    for (std::size_t at = 0; at < held.function_count; ++at)
      CHECK(held.functions[at] ==
            doctest::Approx(static_cast<double>(bent.functions[at])).epsilon(1e-5));
    CHECK(after(5, WristSwitch::off).functions != held.functions);
    CHECK(test.loop->frames().front().rest_changes == 0);
  }

  TEST_CASE("no function leaves its limits, however far a hand bends") {
    auto test = puppet_loop();
    HostTime now = HostClock::now();
    for (std::uint64_t tick = 0; tick < 40; ++tick) {
      test.bend(static_cast<int>(tick % 2) * 60, now += 11ms);
      const Frame& frame = test.frame_after_tick(tick);
      const auto& functions = test.options.rig->puppet().functions;
      for (std::size_t at = 0; at < functions.size(); ++at) {
        CHECK(static_cast<double>(frame.functions[at]) <= functions[at].most + 1e-6);
        CHECK(static_cast<double>(frame.functions[at]) >= functions[at].least - 1e-6);
      }
    }
  }

  TEST_CASE("a tick of a puppet allocates nothing, frees nothing and takes no lock") {
    const std::string text = std::string(test::ball_puppet) +
                             "[clutch]\nleft = \"fist\"\nright = \"pinch\"\nheld_s = 0.25\n"
                             "fist_deg = 90\n";
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      LoopUnderTest test(mode, {.puppet = text.c_str()});
      test::RestraintCounts counts;
      const HostTime begin = HostClock::now();
      {
        const test::Restraint restraint;
        for (std::uint64_t tick = 0; tick < 500; ++tick) {
          test.bend(static_cast<int>(tick % 50), begin + tick * 11ms);
          if (tick % 40 == 0) test.commands.try_push(requests[(tick / 40) % requests.size()]);
          test.frame_after_tick(tick);
        }
        counts = restraint.counts();
      }
      CAPTURE(name_of(mode));
      CHECK(counts.allocations == 0);
      CHECK(counts.frees == 0);
      CHECK(counts.locks == 0);
    }
  }

  TEST_CASE("type 2 plays it along the surface") {
    auto type1 = puppet_loop(), along = puppet_loop(Mode::type2);
    int moves_along = 0;
    HostTime now = HostClock::now();
    for (std::uint64_t tick = 0; tick < 40; ++tick) {
      now += 11ms;
      std::vector<deform::Points> shapes;
      for (LoopUnderTest* const test : {&type1, &along}) {
        test->bend(static_cast<int>(tick), now);
        shapes.push_back(test->vertices_of(test->frame_after_tick(tick)));
      }
      REQUIRE(shapes[1] == shapes[0]); // of one stroke; what adds up are strokes
      const Frame& frame = along.loop->frames().front();
      CHECK(frame.fields.fields().empty());
      moves_along += frame.surface.field != 0 ? 1 : 0;
      if (tick < 39) continue;
      CHECK((shapes[1] - type1.model.vertices).cwiseAbs().maxCoeff() > 0.02);
    }
    CHECK(moves_along > 10);
  }

  TEST_CASE("strokes of type 2 along the surface add up, and an undo goes back stroke by stroke") {
    auto test = puppet_loop(Mode::type2);
    HostTime now = HostClock::now();
    std::uint64_t tick = 0;
    const auto after = [&](int counts) {
      test.bend(counts, now += 11ms);
      return test.vertices_of(test.frame_after_tick(tick++));
    };
    after(0);
    const deform::Points first = after(15);
    test.commands.try_push(Request::commit);
    CHECK(after(15) == first);
    const deform::Points second = after(25);
    CHECK((second - first).cwiseAbs().maxCoeff() > 5e-3);
    test.commands.try_push(Request::undo);
    CHECK(after(25) == first);
    test.commands.try_push(Request::redo);
    CHECK(after(25) == second);
    test.commands.try_push(Request::reset);
    CHECK(after(25) == test.model.vertices);
    CHECK((after(10) - test.model.vertices).cwiseAbs().maxCoeff() > 5e-3);
  }
}

} // namespace rig_loop_test
