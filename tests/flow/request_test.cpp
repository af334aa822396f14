#include <nendo/flow/command.hpp>

#include <atomic>
#include <thread>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"
#include "support/restraint.hpp"

namespace request_test {

using namespace nendo;
using namespace nendo::flow;
using deform::Points;

namespace {

/// Hands that bend as the test says, and a user's requests to the loop.
struct Person {
  test::LoopUnderTest test;
  HostTime now = HostClock::now();
  std::uint64_t tick = 0;

  explicit Person(Mode mode, SwitchAction action = SwitchAction::none)
      : test(mode, {.switch_action = action}) {}

  const Frame& bend(int counts, WristSwitch position = WristSwitch::unknown) {
    now += std::chrono::milliseconds(11);
    for (const Side side : {Side::left, Side::right}) {
      GloveSample sample = test::bent_sample(side, counts, now);
      sample.wrist_switch = position;
      test.rings[Placement::index_of(side)]->try_push(sample);
    }
    return test.frame_after_tick(tick++);
  }
  const Frame& move(int from, int to, WristSwitch position = WristSwitch::unknown) {
    for (int at = from; at != to; at += from < to ? 1 : -1)
      bend(at, position);
    return bend(to, position);
  }
  const Frame& ask(Request request, int counts) {
    REQUIRE(test.commands.try_push(request));
    return bend(counts);
  }
  Points shape() { return test.vertices_of(test.loop->frames().front()); }
};

constexpr std::array modes{Mode::type1, Mode::type2};

} // namespace

TEST_SUITE("request") {
  TEST_CASE("requests have names") {
    for (const Request request : requests)
      CHECK(request_named(name_of(request)) == request);
    CHECK_FALSE(request_named("").has_value());
    CHECK_FALSE(request_named("undoing").has_value());
  }

  TEST_CASE("in type 1, hands that grab again pull the same rest shape from where they are") {
    Person person(Mode::type1);
    person.move(0, 15);
    const Points pulled = person.shape();
    const Frame regrabbed = person.ask(Request::regrab, 15);
    CHECK(regrabbed.held);
    CHECK(regrabbed.rest_changes == 0);
    CHECK((person.shape() - person.test.model.vertices).cwiseAbs().maxCoeff() <= test::float_gap);
    CHECK(regrabbed.redo_steps == 1);
    CHECK(regrabbed.undo_steps == 0);
    // As a person whose hands were there when they grabbed first.
    Person other(Mode::type1);
    other.ask(Request::release, 0);
    other.move(0, 15);
    other.ask(Request::grab, 15);
    person.move(15, 25);
    other.move(15, 25);
    CHECK((person.shape() - other.shape()).cwiseAbs().maxCoeff() <= test::float_gap);
    CHECK((person.shape() - person.test.model.vertices).cwiseAbs().maxCoeff() > 0.01);
    Person third(Mode::type1);
    third.move(0, 15);
    third.ask(Request::regrab, 15);
    third.ask(Request::redo, 15);
    CHECK((third.shape() - pulled).cwiseAbs().maxCoeff() <= test::float_gap);
  }

  TEST_CASE("in type 2, hands that grab again leave the shape, and the step continues") {
    Person person(Mode::type2);
    person.move(0, 15);
    const Points before = person.shape();
    CHECK(person.ask(Request::regrab, 15).rest_changes == 0);
    CHECK(person.shape() == before);
    person.move(15, 22);
    CHECK((person.shape() - before).cwiseAbs().maxCoeff() > 0.005);
    CHECK(person.ask(Request::undo, 22).undo_steps == 0); // both parts together
    CHECK((person.shape() - person.test.model.vertices).cwiseAbs().maxCoeff() <= test::float_gap);
  }

  TEST_CASE("hands that have released the model do not grab again") {
    for (const Mode mode : modes) {
      Person person(mode);
      person.move(0, 15);
      person.ask(Request::release, 15);
      const Points kept = person.shape();
      CHECK_FALSE(person.ask(Request::regrab, 15).held);
      CHECK(person.ask(Request::grab, 15).held);
      CHECK(person.shape() == kept);
    }
  }

  TEST_CASE("hands that release the model leave it alone until they grab it again") {
    for (const Mode mode : modes) {
      Person person(mode);
      CHECK(person.move(0, 15).held);
      CHECK_FALSE(person.ask(Request::release, 15).held);
      const Points kept = person.shape();
      CHECK((kept - person.test.model.vertices).cwiseAbs().maxCoeff() > 0.02);
      person.move(15, 0);
      CHECK(person.shape() == kept);
      CHECK(person.ask(Request::grab, 0).held);
      person.move(0, 10);
      CHECK((person.shape() - kept).cwiseAbs().maxCoeff() > 0.02);
      CHECK(person.test.loop->stats().grabs == 1);
      CHECK(person.test.loop->stats().commits == 1);
    }
  }

  TEST_CASE("undo goes back commit by commit, bit for bit") {
    for (const Mode mode : modes) {
      CAPTURE(name_of(mode));
      Person person(mode);
      std::vector<Points> shapes{person.test.model.vertices};
      for (int round = 1; round <= 3; ++round) {
        person.move(0, 5 * round);
        person.ask(Request::release, 5 * round);
        shapes.push_back(person.shape());
        person.move(5 * round, 0);
        person.ask(Request::grab, 0);
      }
      person.ask(Request::release, 0);
      for (std::uint64_t undos = 1; undos <= 3; ++undos) {
        // Releasing was a commit without a change, for type 1; type 2 keeps changes alone.
        if (undos == 1 && mode == Mode::type1) person.ask(Request::undo, 0);
        shapes.pop_back();
        const Frame& frame = person.ask(Request::undo, 0);
        CHECK(person.test.vertices_of(frame) == shapes.back());
        CHECK(frame.undos == person.test.loop->stats().undos);
        CHECK_FALSE(frame.held);
      }
      person.ask(Request::undo, 0); // there is no more
      CHECK(person.shape() == person.test.model.vertices);
      CHECK(person.test.loop->final_shape() == person.test.model.vertices);
    }
  }

  TEST_CASE("hands that hold the model when it is undone hold the earlier one") {
    for (const Mode mode : modes) {
      Person person(mode);
      person.move(0, 15);
      person.ask(Request::commit, 15);
      CHECK(person.test.loop->stats().commits == 1);
      const Frame& undone = person.ask(Request::undo, 15);
      CHECK(undone.held);
      CHECK(undone.shape_jumps == 1);
      CHECK(person.shape() == person.test.model.vertices);
      person.move(15, 25);
      CHECK((person.shape() - person.test.model.vertices).cwiseAbs().maxCoeff() > 0.02);
    }
  }

  TEST_CASE("what hands have pulled since a commit is undone first, as a step of its own") {
    for (const Mode mode : modes) {
      CAPTURE(name_of(mode));
      Person person(mode);
      person.move(0, 12);
      person.ask(Request::commit, 12);
      const Points committed = person.shape();
      CHECK(person.move(12, 25).undo_steps == 2);
      const Points pulled = person.shape();
      REQUIRE(pulled != committed);
      const Frame& back = person.ask(Request::undo, 25);
      CHECK(person.shape() == committed);
      CHECK(back.held);
      CHECK(back.undo_steps == 1);
      CHECK(back.redo_steps == 1);
      person.ask(Request::redo, 25);
      CHECK(person.shape() == pulled);
      person.ask(Request::undo, 25);
      CHECK(person.shape() == committed);
      CHECK(person.ask(Request::undo, 25).undo_steps == 0);
      CHECK(person.shape() == person.test.model.vertices);
      CHECK(person.bend(25).redo_steps == 2);
    }
  }

  TEST_CASE("what a puppet has pulled along the surface is undone in the same way") {
    const auto puppet = puppet::parse_puppet("version = 1\nmodel = \"ball.obj\"\n"
                                             "[points]\nnose = { at = [0, 0, 1], radius = 1 }\n"
                                             "[functions.poke]\ninput = \"left.index_flexion\"\n"
                                             "travel_deg = 90\nmove = { nose = [0, 0, 0.3] }\n",
                                             "test");
    REQUIRE(puppet);
    Person person(Mode::type1);
    auto& test = person.test;
    test.options.rig = std::make_shared<const puppet::Rig>(*puppet, test.model);
    test.options.sculptor.deformer.supports = test.options.rig->supports();
    test.loop = std::make_unique<DeformLoop>(test.model, test.placement, test.inputs, test.options);
    person.move(0, 12);
    person.ask(Request::commit, 12);
    const Points committed = person.shape();
    person.move(12, 25);
    const Points pulled = person.shape();
    REQUIRE((pulled != committed));
    const Frame& back = person.ask(Request::undo, 25);
    CHECK((person.shape() == committed));
    CHECK(back.held);
    CHECK(back.redo_steps == 1);
    person.ask(Request::redo, 25);
    CHECK((person.shape() == pulled));
    person.ask(Request::undo, 25);
    person.ask(Request::undo, 25);
    CHECK((person.shape() == test.model.vertices));
    CHECK(person.bend(25).redo_steps == 2);
  }

  TEST_CASE("a pull is undone before a change of settings that came before it") {
    Person person(Mode::type1);
    person.move(0, 12);
    LoopSettings other = person.test.loop->changes().settings();
    other.kernel = deform::Wendland::c4;
    REQUIRE(person.test.loop->changes().change_settings(other));
    person.bend(12);
    const Points changed = person.shape();
    person.move(12, 25);
    REQUIRE(person.shape() != changed);
    const Frame& frame = person.ask(Request::undo, 25);
    CHECK(person.shape() == changed);
    CHECK(frame.settings == other);
    CHECK_FALSE(frame.awaited.has_value());
  }

  TEST_CASE("a pull is also undone where there is no memory for undo") {
    Person person(Mode::type1);
    person.test.options.sculptor.deformer.undo_bytes = 0;
    person.test.loop = std::make_unique<DeformLoop>(person.test.model, person.test.placement,
                                                    person.test.inputs, person.test.options);
    person.move(0, 12);
    person.ask(Request::commit, 12);
    const Points committed = person.shape();
    person.move(12, 25);
    REQUIRE(person.shape() != committed);
    CHECK(person.ask(Request::undo, 25).redo_steps == 0);
    CHECK(person.shape() == committed);
  }

  TEST_CASE("redo goes forth commit by commit, bit for bit, and a commit ends it") {
    for (const Mode mode : modes) {
      CAPTURE(name_of(mode));
      Person person(mode);
      const auto pull = [&](int to) {
        person.ask(Request::grab, 0);
        person.move(0, to);
        person.ask(Request::release, to);
        person.move(to, 0);
        return person.shape();
      };
      std::vector<Points> shapes{person.test.model.vertices};
      for (const int to : {5, 15, 10, 20})
        shapes.push_back(pull(to));
      const std::size_t last = shapes.size() - 1;
      for (std::size_t back = 1; back <= last; ++back) {
        for (std::size_t at = last; at-- > last - back;) {
          person.ask(Request::undo, 0);
          CHECK(person.shape() == shapes[at]);
        }
        for (std::size_t at = last - back; at++ < last;) {
          const std::uint64_t steps = person.test.loop->frames().front().shape_jumps;
          CHECK(person.ask(Request::redo, 0).shape_jumps == steps + 1);
          CHECK(person.shape() == shapes[at]);
        }
      }
      const std::uint64_t redos = person.test.loop->stats().redos;
      CHECK(redos == 1 + 2 + 3 + 4);
      person.ask(Request::redo, 0); // there is no more
      person.ask(Request::undo, 0);
      const Points other = pull(12);
      person.ask(Request::redo, 0); // nor now
      CHECK(person.shape() == other);
      CHECK(person.test.loop->stats().redos == redos);
    }
  }

  TEST_CASE("undos and redos that come together are done in their order") {
    for (const Mode mode : modes) {
      Person person(mode);
      person.move(0, 15);
      person.ask(Request::release, 15);
      const Points shaped = person.shape();
      for (const Request request : {Request::redo, Request::undo, Request::redo})
        person.test.commands.try_push(request);
      person.bend(15);
      CHECK(person.shape() == shaped);
      for (const Request request : {Request::redo, Request::undo})
        person.test.commands.try_push(request);
      person.bend(15);
      CHECK(person.shape() == person.test.model.vertices);
    }
  }

  TEST_CASE("what hands that hold the model have begun since an undo goes with a redo") {
    for (const Mode mode : modes) {
      Person person(mode);
      person.move(0, 15);
      person.ask(Request::commit, 15);
      const Points shaped = person.shape();
      person.ask(Request::undo, 15);
      person.move(15, 25);
      CHECK(person.shape() != shaped);
      CHECK(person.ask(Request::redo, 25).held);
      CHECK(person.shape() == shaped);
    }
  }

  TEST_CASE("undo goes back as far as one likes where memory is refilled, without allocation in a "
            "tick, and no farther than memory allows where it is not") {
    constexpr int commits = 400; // whole shapes, each more than the loop begins with
    for (const Mode mode : modes) {
      for (const bool refills : {true, false}) {
        CAPTURE(name_of(mode));
        CAPTURE(refills);
        Person person(mode);
        person.test.options.sculptor.deformer.undo_bytes = 100'000;
        person.test.options.undo_max_bytes = refills ? std::size_t{1} << 30 : 0;
        person.test.loop = std::make_unique<DeformLoop>(person.test.model, person.test.placement,
                                                        person.test.inputs, person.test.options);
        std::vector<Points> shapes;
        test::RestraintCounts counts;
        const auto ask = [&](Request request, int bent) {
          if (refills) person.test.loop->changes().refill_undo();
          const test::Restraint restraint;
          person.test.commands.try_push(request);
          person.bend(bent);
          counts.allocations += restraint.counts().allocations;
          counts.frees += restraint.counts().frees;
          counts.locks += restraint.counts().locks;
        };
        for (int at = 0; at < commits; ++at) {
          ask(Request::commit, at % 2 == 0 ? 12 : 0);
          shapes.push_back(person.shape());
        }
        ask(Request::release, 0);
        const auto& stats = person.test.loop->stats();
        CHECK((stats.forgotten_steps > 0) != refills);
        CHECK(stats.undo_steps + stats.forgotten_steps >= commits - 1);
        if (refills) CHECK(stats.undo_steps >= commits - 1);
        const std::uint64_t steps = stats.undo_steps;
        const Points end = person.shape();
        for (std::uint64_t at = 0; at < steps; ++at)
          ask(Request::undo, 0);
        if (refills) CHECK(person.shape() == person.test.model.vertices);
        CHECK(stats.undo_steps == 0);
        for (std::uint64_t at = 0; at < steps; ++at)
          ask(Request::redo, 0);
        CHECK(person.shape() == end);
        CHECK(counts.allocations + counts.frees + counts.locks == 0);
      }
    }
  }

  TEST_CASE("memory comes from another thread while the loop commits and undoes") {
    Person person(Mode::type1);
    person.test.options.sculptor.deformer.undo_bytes = 0;
    person.test.options.undo_max_bytes = std::size_t{1} << 30;
    person.test.loop = std::make_unique<DeformLoop>(person.test.model, person.test.placement,
                                                    person.test.inputs, person.test.options);
    std::atomic<bool> over{false};
    std::thread refills([&] {
      while (!over) {
        person.test.loop->changes().refill_undo();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
    constexpr std::uint64_t commits = 60;
    for (std::uint64_t at = 1; at < commits; ++at)
      person.ask(Request::commit, at % 2 == 0 ? 12 : 0);
    person.ask(Request::release, 12);
    const auto& stats = person.test.loop->stats();
    const std::uint64_t steps = stats.undo_steps;
    CHECK(steps >= 3); // more, the more often the other thread had its turn
    CHECK(steps + stats.forgotten_steps == commits);
    const Points end = person.shape();
    for (std::uint64_t at = 0; at < steps; ++at)
      person.ask(Request::undo, 0);
    CHECK(stats.undo_steps == 0);
    if (steps == commits) CHECK(person.shape() == person.test.model.vertices);
    for (std::uint64_t at = 0; at < steps; ++at)
      person.ask(Request::redo, 0);
    over = true;
    refills.join();
    CHECK(person.shape() == end);
  }

  TEST_CASE("a frame shows how often one can undo and redo, and at 0 neither changes anything") {
    for (const Mode mode : modes) {
      CAPTURE(name_of(mode));
      Person person(mode);
      CHECK(person.bend(0).undo_steps == 0); // held, and not shaped yet
      const Points rest = person.shape();
      CHECK(person.ask(Request::undo, 0).undo_steps == 0);
      CHECK(person.ask(Request::redo, 0).redo_steps == 0);
      CHECK(person.shape() == rest);

      CHECK(person.move(0, 12).undo_steps == 1); // what is held, and of no commit
      CHECK(person.shape() != rest);
      CHECK(person.ask(Request::undo, 12).undo_steps == 0);
      CHECK(person.shape() == rest);

      person.move(12, 5);
      CHECK(person.ask(Request::commit, 5).undo_steps == 1);
      person.move(5, 15);
      person.ask(Request::release, 15);
      const Points end = person.shape();
      const std::uint64_t steps = person.bend(15).undo_steps;
      CHECK(steps >= 2);
      for (std::uint64_t undone = 0; undone < steps; ++undone) {
        const Frame& frame = person.ask(Request::undo, 15);
        CHECK(frame.undo_steps == steps - undone - 1);
        CHECK(frame.redo_steps >= undone + 1);
      }
      CHECK(person.shape() == rest);
      const std::uint64_t redos = person.bend(15).redo_steps;
      for (std::uint64_t redone = 0; redone < redos; ++redone)
        CHECK(person.ask(Request::redo, 15).redo_steps == redos - redone - 1);
      CHECK(person.shape() == end);
      CHECK(person.bend(15).undo_steps == redos);
    }
  }

  TEST_CASE("a commit without a hand that holds is none") {
    Person person(Mode::type1);
    person.ask(Request::release, 0);
    const std::uint64_t commits = person.test.loop->stats().commits;
    person.ask(Request::commit, 0);
    person.ask(Request::grab, 0);
    person.move(0, 5);
    CHECK(person.test.loop->stats().commits == commits);
  }

  TEST_CASE("where a switch grabs, a request holds until the switch is used") {
    Person person(Mode::type1, SwitchAction::grab);
    CHECK_FALSE(person.move(0, 5, WristSwitch::off).held);
    CHECK(person.ask(Request::grab, 5).held);
    CHECK(person.move(5, 10, WristSwitch::off).held);
    person.move(10, 15, WristSwitch::on);
    CHECK_FALSE(person.move(15, 10, WristSwitch::off).held);
  }

  TEST_CASE("requests allocate nothing and take no lock") {
    for (const Mode mode : modes) {
      Person person(mode);
      test::RestraintCounts counts;
      {
        const test::Restraint restraint;
        for (int round = 0; round < 20; ++round) {
          for (const Request request : requests) {
            person.test.commands.try_push(request);
            person.bend(round % 7);
            person.bend(round % 5);
          }
        }
        counts = restraint.counts();
      }
      CHECK(counts.allocations + counts.frees + counts.locks == 0);
      CHECK(person.test.loop->stats().undos == 20);
      CHECK(person.test.loop->stats().failed == 0);
    }
  }
}

} // namespace request_test
