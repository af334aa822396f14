// Settings change from one tick to the next: the shape does not, the history stays, and what
// follows is what a loop of these settings makes of that shape.

#include <atomic>
#include <random>
#include <thread>

#include <doctest/doctest.h>

#include "support/clocked_loop.hpp"
#include "support/late_maker.hpp"
#include "support/restraint.hpp"
#include "support/rounds.hpp"

namespace exchange_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::flow;
using nendo::test::Clocked;
using nendo::test::gap;
using nendo::test::LoopUnderTest;
using nendo::test::Restraint;

namespace {

LoopSettings with_radius(LoopSettings settings, double radius_m) {
  settings.radius_m.fill(radius_m);
  return settings;
}

} // namespace

TEST_SUITE("exchange") {
  TEST_CASE("hands that rest do not move the shape, whatever is changed") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      CAPTURE(name_of(mode));
      Clocked loop(mode, {.rings_of_ball = 12, .filter = hand::FilterKind::one_euro});
      deform::Points shape = loop.stroke(0, 15);
      for (int tick = 0; tick < 400; ++tick) // the filter lets the hands come to rest
        shape = loop.bent(15);
      loop.test.commands.try_push(Request::commit); // completes a stroke of type 2
      shape = loop.bent(15);
      CHECK(gap(shape, loop.test.model.vertices) > 1e-2);
      std::mt19937 random(7);
      for (int at = 0; at < 60; ++at) {
        loop.change(test::any_settings(loop.test.loop->changes().settings(), random));
        for (int tick = 0; tick < 2; ++tick)
          CHECK(gap(loop.bent(15), shape) < 1e-6);
      }
      CHECK(loop.test.loop->stats().changes > 30);
    }
  }

  TEST_CASE("a change of the filter in mid-motion does not move the shape by itself") {
    Clocked loop(Mode::type1, {.rings_of_ball = 12, .filter = hand::FilterKind::one_euro});
    deform::Points shape = loop.stroke(0, 30); // the filter is late now
    LoopSettings settings = loop.test.loop->changes().settings();
    settings.filter.kind = hand::FilterKind::off;
    loop.change(settings);
    shape = loop.tick();
    for (int tick = 0; tick < 3; ++tick)
      CHECK(gap(loop.tick(), shape) < 1e-6);
    CHECK(loop.frame().settings.filter.kind == hand::FilterKind::off);
  }

  TEST_CASE("after a change the loop does what one does that begins there with those settings") {
    for (unsigned seed = 0; seed < 12; ++seed) {
      CAPTURE(seed);
      std::mt19937 random(seed);
      Clocked loop(seed % 2 == 0 ? Mode::type1 : Mode::type2);
      loop.stroke(0, 15);
      const LoopSettings before = loop.test.loop->changes().settings();
      LoopSettings settings = before;
      while (settings == before)
        settings = test::any_settings(before, random);
      loop.change(settings);
      loop.bent(16);
      // Another loop, of the options that these settings mean, which begins with this shape.
      LoopOptions options = loop.test.options;
      options.sculptor = loop.test.loop->changes().sculptor_options();
      const LoopSettings of_sculptor =
          settings_of(options.sculptor, settings.filter, loop.test.placement.units_per_metre);
      CHECK(of_sculptor.mode == settings.mode);
      CHECK(of_sculptor.kernel == settings.kernel);
      CHECK(of_sculptor.injective == settings.injective);
      CHECK(of_sculptor.piece_fraction == doctest::Approx(settings.piece_fraction));
      for (std::size_t finger = 0; finger < 5; ++finger)
        CHECK(of_sculptor.radius_m[finger] == doctest::Approx(settings.radius_m[finger]));
      LoopUnderTest other(Mode::type1, {.rings_of_ball = 12});
      for (auto& input : other.inputs) {
        input.first = test::bent_sample(input.side, 16, loop.now);
        input.filter = settings.filter;
      }
      options.commands = &other.commands;
      other.loop = std::make_unique<DeformLoop>(loop.test.model, loop.test.placement, other.inputs,
                                                options, &loop.frame().shape);
      for (int counts = 17; counts < 30; ++counts) {
        const deform::Points shape = loop.bent(counts);
        other.bend(counts, loop.now);
        CHECK(gap(other.vertices_of(other.frame_after_tick(loop.number)), shape) < 1e-6);
      }
    }
  }

  TEST_CASE("a commit or a release is a commit, and a stroke that a change ends is none") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      CAPTURE(name_of(mode));
      Clocked loop(mode);
      loop.stroke(0, 15);
      loop.change(with_radius(loop.test.loop->changes().settings(), 0.3));
      loop.bent(15);
      CHECK(loop.frame().commits == 0);
      CHECK(loop.frame().rest_changes == 1);
      loop.stroke(15, 25);
      REQUIRE(loop.test.commands.try_push(Request::commit));
      loop.bent(25);
      CHECK(loop.frame().commits == 1);
      CHECK(loop.frame().rest_changes == 2);
      loop.stroke(25, 10);
      REQUIRE(loop.test.commands.try_push(Request::release));
      loop.bent(10);
      CHECK(loop.frame().commits == 2);
      CHECK(loop.frame().rest_changes == 3);
      CHECK(loop.test.loop->stats().commits == loop.frame().commits);
    }
  }

  TEST_CASE("undos that find too many waiting are refused and counted") {
    Clocked loop(Mode::type1);
    loop.stroke(0, 15);
    loop.change(with_radius(loop.test.loop->changes().settings(), 0.3));
    loop.bent(15);
    const std::size_t capacity = loop.test.commands.capacity();
    for (int round = 0; round < 2; ++round) {
      for (std::size_t at = 0; at < capacity; ++at)
        REQUIRE(loop.test.commands.try_push(Request::undo));
      loop.bent(15);
      CHECK(loop.frame().awaited); // what the first awaits, whose change is not made
    }
    CHECK(loop.frame().steps_due == capacity);
    CHECK(loop.test.loop->stats().refused_steps == capacity);
  }

  TEST_CASE("undo leads back over changes to the beginning, and redo forth again") {
    for (const auto& [mode, other] : {std::pair{Mode::type1, Mode::type1},
                                      {Mode::type1, Mode::type2},
                                      {Mode::type2, Mode::type1},
                                      {Mode::type2, Mode::type2}}) {
      const Mode from = mode, to = other; // Clang 14 captures no structured bindings
      CAPTURE(name_of(from));
      CAPTURE(name_of(to));
      Clocked loop(from);
      std::vector<deform::Points> shapes{loop.test.model.vertices};
      loop.stroke(0, 15);
      const LoopSettings first = loop.test.loop->changes().settings();
      LoopSettings settings = with_radius(first, 0.3);
      settings.mode = to;
      const LoopSettings second = settings;
      loop.change(settings);
      shapes.push_back(loop.bent(15));
      loop.stroke(15, 25);
      REQUIRE(loop.test.commands.try_push(Request::commit));
      shapes.push_back(loop.bent(25));
      loop.stroke(25, 5);
      loop.now += 2s; // a step of its own
      settings = with_radius(settings, 0.15);
      loop.change(settings);
      shapes.push_back(loop.bent(5));
      for (std::size_t at = 1; at < shapes.size(); ++at)
        CHECK(gap(shapes[at], shapes[at - 1]) > 1e-3);
      // A stroke, a change of radius and perhaps mode, a stroke; a stroke, a change of radius.
      const auto change = from == to ? StepKind::radius : StepKind::settings;
      CHECK(loop.kinds() == std::vector{StepKind::stroke, change, StepKind::stroke,
                                        StepKind::stroke, StepKind::radius});
      CHECK(loop.frame().undo_steps == 5);
      CHECK(gap(loop.step(Request::undo), shapes[3]) < test::float_gap);
      CHECK(loop.frame().settings == settings); // that frame was still made with them
      CHECK(gap(loop.tick(), shapes[3]) < test::float_gap);
      CHECK(loop.frame().settings == second);
      CHECK(gap(loop.step(Request::undo), shapes[2]) < test::float_gap);
      CHECK(gap(loop.step(Request::undo), shapes[1]) < test::float_gap);
      CHECK(gap(loop.step(Request::undo), shapes[1]) < test::float_gap);
      loop.tick();
      CHECK(loop.frame().settings == first);
      CHECK(loop.frame().undo_steps == 1);
      CHECK(loop.frame().redo_steps == 4);
      CHECK(loop.frame().steps.undoable == 1);
      CHECK(loop.kinds() == std::vector{StepKind::stroke, change, StepKind::stroke,
                                        StepKind::stroke, StepKind::radius});
      CHECK(gap(loop.step(Request::undo), loop.test.model.vertices) == 0.0); // to the last bit
      for (const std::size_t at : {1U, 1U, 2U, 3U, 3U})
        CHECK(gap(loop.step(Request::redo), shapes[at]) < test::float_gap);
      loop.tick();
      CHECK(loop.frame().redo_steps == 0);
      CHECK(loop.frame().settings == settings);
    }
  }

  TEST_CASE(
      "whatever was shaped and changed, undo leads to the model, and redo to the last shape") {
    for (unsigned seed = 0; static_cast<int>(seed) < test::rounds(20); ++seed) {
      CAPTURE(seed);
      std::mt19937 random(seed);
      Clocked loop(seed % 2 == 0 ? Mode::type1 : Mode::type2);
      int counts = 0;
      for (int at = 0; at < 12; ++at) {
        const int next = static_cast<int>(random() % 30);
        loop.stroke(counts, next);
        counts = next;
        if (random() % 2 == 0)
          loop.change(test::any_settings(loop.test.loop->changes().settings(), random));
        if (random() % 3 == 0) loop.test.commands.try_push(Request::commit);
        if (random() % 8 == 0) loop.test.commands.try_push(Request::reset);
        loop.bent(counts, random() % 2 == 0 ? 11ms : 2000ms);
      }
      loop.test.commands.try_push(Request::release);
      loop.bent(counts);
      const deform::Points shape = loop.bent(counts);
      const LoopSettings settings = loop.frame().settings;
      const std::uint64_t steps = loop.frame().undo_steps;
      CHECK(steps > 5);
      while (loop.frame().undo_steps > 0)
        loop.step(Request::undo);
      CHECK(loop.frame().redo_steps == steps);
      CHECK(gap(loop.bent(counts), loop.test.model.vertices) == 0.0);
      while (loop.frame().redo_steps > 0)
        loop.step(Request::redo);
      CHECK(loop.frame().undo_steps == steps);
      CHECK(gap(loop.bent(counts), shape) == 0.0);
      CHECK(loop.frame().settings == settings);
    }
  }

  TEST_CASE("a change that led nowhere is undone at once, and a new one forgets what was undone") {
    Clocked loop(Mode::type1);
    loop.stroke(0, 10);
    const LoopSettings first = loop.test.loop->changes().settings();
    loop.change(with_radius(first, 0.3));
    loop.bent(10);
    loop.change(first); // within a second
    loop.bent(10);
    CHECK(loop.frame().undo_steps == 2);
    REQUIRE(loop.test.commands.try_push(Request::undo));
    loop.tick();
    CHECK_FALSE(loop.frame().awaited);
    CHECK(loop.frame().undo_steps == 1);
    CHECK(loop.frame().redo_steps == 1);
    loop.now += 2s;
    loop.change(with_radius(first, 0.25));
    loop.bent(10);
    CHECK(loop.frame().redo_steps == 0);
    CHECK(loop.kinds() == std::vector{StepKind::stroke, StepKind::radius});
  }

  TEST_CASE("an undo that waits for settings holds back what comes after it, and not for ever") {
    Clocked loop(Mode::type1);
    const LoopSettings first = loop.test.loop->changes().settings();
    loop.stroke(0, 10);
    loop.change(with_radius(first, 0.3));
    loop.bent(10);
    REQUIRE(loop.test.commands.try_push(Request::undo));
    REQUIRE(loop.test.commands.try_push(Request::undo));
    for (int tick = 0; tick < 5; ++tick) {
      loop.tick();
      CHECK(loop.frame().awaited == Awaited{first, 0, 0});
      CHECK(loop.frame().shape_jumps == 0);
    }
    loop.change(first);
    loop.tick();
    CHECK(loop.frame().shape_jumps == 1);
    CHECK(gap(loop.tick(), loop.test.model.vertices) == 0.0);
    CHECK(loop.frame().shape_jumps == 2);
    // Another change while an undo waits is a step of its own, which the undo then means.
    loop.now += 2s;
    loop.change(with_radius(first, 0.25));
    loop.tick();
    REQUIRE(loop.test.commands.try_push(Request::undo));
    loop.tick();
    loop.now += 2s;
    loop.change(with_radius(first, 0.15));
    loop.tick();
    CHECK(loop.frame().shape_jumps == 2);
    loop.tick();
    CHECK(loop.frame().awaited == Awaited{with_radius(first, 0.25), 0, 0});
  }

  TEST_CASE("a hundred ticks of brushing are no undo, and an undo is one") {
    Clocked loop(Mode::type2);
    LoopSettings settings = loop.test.loop->changes().settings();
    settings.brushes.fill(deform::Brush::inflate);
    loop.change(settings);
    loop.bent(0);
    for (int round = 0; round < 2; ++round) {
      loop.stroke(0, 25);
      loop.stroke(25, 0);
    }
    CHECK(loop.frame().undos == 0);
    CHECK(loop.frame().shape_jumps > 5); // each piece is one, which no field describes
    REQUIRE(loop.test.commands.try_push(Request::undo));
    CHECK(gap(loop.bent(0), loop.test.model.vertices) == 0.0);
    CHECK(loop.frame().undos == 1);
  }

  TEST_CASE("what is shaped between changes within a second is one step") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      Clocked loop(mode);
      LoopSettings settings = loop.test.loop->changes().settings();
      loop.change(with_radius(settings, 0.31)); // nothing is shaped yet: the change alone
      loop.bent(0);
      CHECK(loop.kinds() == std::vector{StepKind::radius});
      for (int at = 0; at < 10; ++at) {
        loop.stroke(2 * at, 2 * at + 2);
        loop.change(with_radius(settings, 0.3 - 0.01 * at));
      }
      const deform::Points shape = loop.bent(20);
      CHECK(gap(shape, loop.test.model.vertices) > 1e-2);
      CHECK(loop.kinds() == std::vector{StepKind::radius});
      CHECK(loop.frame().undo_steps == 2);
      CHECK(gap(loop.step(Request::undo), loop.test.model.vertices) == 0.0);
      loop.step(Request::undo);
      loop.tick();
      CHECK(loop.frame().settings == settings);
      loop.step(Request::redo);
      CHECK(gap(loop.step(Request::redo), shape) < test::float_gap);
    }
  }

  TEST_CASE("a reset goes back to the model to the last bit, and undo takes it back") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      CAPTURE(name_of(mode));
      Clocked loop(mode);
      loop.stroke(0, 15);
      REQUIRE(loop.test.commands.try_push(Request::commit));
      const deform::Points shape = loop.stroke(15, 22);
      REQUIRE(loop.test.commands.try_push(Request::reset));
      CHECK(gap(loop.bent(21), loop.test.model.vertices) == 0.0);
      CHECK(loop.test.loop->stats().resets == 1);
      REQUIRE(loop.test.commands.try_push(Request::undo));
      CHECK(gap(loop.bent(21), shape) < test::float_gap);
      REQUIRE(loop.test.commands.try_push(Request::reset));
      REQUIRE(loop.test.commands.try_push(Request::reset)); // which changes nothing more
      CHECK(gap(loop.bent(21), loop.test.model.vertices) == 0.0);
      CHECK(gap(loop.stroke(21, 30), loop.test.model.vertices) > 1e-3); // the hands hold it
    }
  }

  TEST_CASE(
      "back to the settings at first is back to the options at first, with all weights of radii") {
    Clocked loop(Mode::type1);
    LoopOptions& options = loop.test.options;
    options.sculptor.deformer.supports = {{{0.4, 1.0}, {1.5, 0.25}}, {{3, {0.75, 2.0}}}};
    loop.test.loop = std::make_unique<DeformLoop>(loop.test.model, loop.test.placement,
                                                  loop.test.inputs, options);
    const LoopSettings first = loop.test.loop->changes().settings();
    loop.change(with_radius(first, 0.3));
    loop.bent(5);
    const auto supports = [&] {
      return loop.test.loop->changes().sculptor_options().deformer.supports;
    };
    CHECK(supports().shared.size() == 1);
    loop.step(Request::undo);
    CHECK(supports().shared == options.sculptor.deformer.supports.shared);
    CHECK(supports().own == options.sculptor.deformer.supports.own);
  }

  TEST_CASE("settings that nothing can be done with are refused, and change nothing") {
    Clocked loop(Mode::type1);
    const LoopSettings before = loop.test.loop->changes().settings();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double radius : {0.0, -0.1, nan, 1e300, std::numeric_limits<double>::infinity()}) {
      LoopSettings settings = before;
      settings.radius_m[3] = radius;
      CHECK_FALSE(loop.test.loop->changes().change_settings(settings));
    }
    LoopSettings settings = before;
    settings.piece_fraction = nan;
    CHECK_FALSE(loop.test.loop->changes().change_settings(settings));
    settings = before;
    settings.filter.min_cutoff_hz = nan;
    CHECK_FALSE(loop.test.loop->changes().change_settings(settings));
    CHECK(loop.test.loop->changes().settings() == before);
    CHECK_FALSE(loop.test.loop->changes().is_changing());
    loop.tick();
    CHECK(loop.test.loop->stats().changes == 0);
  }

  TEST_CASE(
      "of changes that the loop has not taken only the last counts, and none if it leads back") {
    Clocked loop(Mode::type1);
    const LoopSettings before = loop.test.loop->changes().settings();
    loop.change(with_radius(before, 0.2));
    loop.change(with_radius(before, 0.25));
    CHECK(loop.test.loop->changes().is_changing());
    loop.bent(1);
    CHECK_FALSE(loop.test.loop->changes().is_changing());
    CHECK(loop.test.loop->stats().changes == 1);
    loop.bent(2);
    CHECK(loop.frame().settings == with_radius(before, 0.25));
    loop.change(before);
    loop.change(with_radius(before, 0.25));
    CHECK_FALSE(loop.test.loop->changes().is_changing());
    loop.bent(3);
    CHECK(loop.test.loop->stats().changes == 1);
    CHECK(loop.test.loop->changes().sculptor_options().deformer.supports.shared.front().radius ==
          doctest::Approx(0.25 * loop.test.placement.units_per_metre));
  }

  TEST_CASE(
      "100,000 ticks with commands of all kinds allocate nothing, free nothing, lock nothing") {
    constexpr std::uint64_t ticks = test::rounds(25'000);
    test::RestraintCounts sum;
    std::uint64_t changes = 0;
    int models = 0;
    for (unsigned seed = 0; seed < 4; ++seed) {
      InputLog log;
      LoopUnderTest test(seed % 2 == 0 ? Mode::type1 : Mode::type2,
                         {.rings_of_ball = 6, .adapt = CountScale{}, .input_log = &log});
      std::mt19937 random(seed);
      test::LateMaker maker(seed, 1000);
      HostTime now = HostClock::now();
      int counts = 0;
      for (std::uint64_t tick = 0; tick < ticks; ++tick) {
        if (random() % 12 == 0)
          static_cast<void>(test.loop->changes().change_settings(
              test::any_settings(test.loop->changes().settings(), random)));
        maker.turn(*test.loop);
        if (tick % 300 == 299) // back to coarser models, from which finer ones can be made
          for (int undo = 0; undo < 30; ++undo)
            test.commands.try_push(Request::undo);
        if (random() % 400 == 0 && maker.is_idle(*test.loop))
          test.loop->changes().change_log(random() % 2 == 0 ? &log : nullptr,
                                          test.loop->frames().front().shape);
        if (random() % 8 == 0) test.commands.try_push(requests[random() % requests.size()]);
        if (random() % 8 == 0)
          test.commands.try_push(WristMove::to(Side::left, test.placement.T_stage_wrist[0]));
        counts = std::clamp(counts + static_cast<int>(random() % 5) - 2, 0, 40);
        now += 1ms;
        test.bend(counts, now);
        {
          const Restraint restraint;
          test.loop->tick(tick, now, now);
          const test::RestraintCounts of_tick = restraint.counts();
          sum.allocations += of_tick.allocations;
          sum.frees += of_tick.frees;
          sum.locks += of_tick.locks;
        }
        if (random() % 2 == 0 && test.loop->frames().update()) // a reader that comes when it likes
          if (const auto& awaited = test.loop->frames().front().awaited)
            static_cast<void>(test.loop->changes().change_to(*awaited));
        log.drain([](const auto&) noexcept {});
        test.loop->changes().take_state();
        test.loop->changes().refill_undo();
      }
      changes += test.loop->stats().changes;
      models += maker.made();
      CHECK(test.loop->stats().undos + test.loop->stats().resets > 25);
    }
    CHECK(sum.allocations == 0);
    CHECK(sum.frees == 0);
    CHECK(sum.locks == 0);
    CHECK(changes > static_cast<std::uint64_t>(test::rounds(5000)));
    CHECK(models > test::rounds(25));
  }

  TEST_CASE(
      "a loop on its own thread takes what another thread asks for, all of it, in its order") {
    InputLog log;
    LoopUnderTest test(Mode::type1, {.rings_of_ball = 8, .rate_hz = 2000.0, .input_log = &log});
    std::atomic<bool> over{false};
    std::thread thread([&] { test.loop->run(over); });
    std::mt19937 random(3);
    LoopSettings last{};
    std::uint64_t taken = 0;
    int logs = 0;
    const auto read = [&](const InputLogEntry& entry) noexcept {
      const auto* const command = std::get_if<Command>(&entry);
      if (command == nullptr || !std::holds_alternative<ChangeSettings>(*command)) return;
      last = std::get<ChangeSettings>(*command).settings;
      ++taken;
    };
    for (int turn = 0; turn < 200; ++turn) {
      test.bend(turn % 30, HostClock::now());
      static_cast<void>(test.loop->changes().change_settings(
          test::any_settings(test.loop->changes().settings(), random)));
      if (turn % 10 == 0) test.loop->changes().change_log(&log, test.loop->frames().front().shape);
      test.loop->frames().update();
      if (turn % 3 == 0) std::this_thread::sleep_for(1ms);
      if (test.loop->changes().take_state()) ++logs;
      log.drain(read);
    }
    const HostTime latest = HostClock::now() + 10s;
    while (test.loop->changes().is_changing() && HostClock::now() < latest)
      std::this_thread::sleep_for(1ms);
    over = true;
    thread.join();
    log.drain(read);
    while (test.loop->changes().take_state())
      ++logs;
    CHECK(last == test.loop->changes().settings());
    CHECK(taken == test.loop->stats().changes);
    CHECK(taken > 20);
    CHECK(logs > 5);
    CHECK(log.lost() == 0);
  }
}

} // namespace exchange_test
