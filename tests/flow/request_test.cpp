#include <nendo/flow/request.hpp>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"
#include "support/restraint.hpp"

using namespace nendo;
using namespace nendo::flow;
using deform::Points;

namespace {

/// Hands that bend as told, and a person who asks the loop for something.
struct Person {
  test::LoopUnderTest test;
  HostTime now = HostClock::now();
  std::uint64_t tick = 0;

  explicit Person(Mode mode, SwitchAction action = SwitchAction::none)
      : test(mode, 24, 1000.0, action) {}

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
    REQUIRE(test.requests.try_push(request));
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
    CHECK_FALSE(request_named("redo").has_value());
  }

  TEST_CASE("hands that let go leave the model alone until they take hold of it again") {
    for (const Mode mode : modes) {
      Person person(mode);
      CHECK(person.move(0, 15).held);
      CHECK_FALSE(person.ask(Request::let_go, 15).held);
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
        person.ask(Request::let_go, 5 * round);
        shapes.push_back(person.shape());
        person.move(5 * round, 0);
        person.ask(Request::grab, 0);
      }
      person.ask(Request::let_go, 0);
      for (std::uint64_t undos = 1; undos <= 3; ++undos) {
        // Letting go was a commit without a change, for type 1; type 2 keeps changes alone.
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
      CHECK(undone.undos == 1);
      CHECK(person.shape() == person.test.model.vertices);
      person.move(15, 25);
      CHECK((person.shape() - person.test.model.vertices).cwiseAbs().maxCoeff() > 0.02);
    }
  }

  TEST_CASE("a commit that nobody holds is none") {
    Person person(Mode::type1);
    person.ask(Request::let_go, 0);
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
            person.test.requests.try_push(request);
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
