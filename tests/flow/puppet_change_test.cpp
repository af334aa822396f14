// A loop continues with an edited puppet: the shape changes by what the edit asks for, and by
// nothing else.

#include <cmath>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "support/any_puppet.hpp"
#include "support/clocked_loop.hpp"
#include "support/restrained_ticks.hpp"
#include "support/rounds.hpp"

namespace puppet_change_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::flow;
using nendo::test::Clocked;
using nendo::test::gap;
using nendo::test::rig_of;

namespace {

const test::LoopFixture with_puppet{.rings_of_ball = 12, .puppet = test::ball_puppet};

std::shared_ptr<const puppet::Rig> edited(const Clocked& loop, const Result<puppet::Puppet>& to) {
  REQUIRE_MESSAGE(to, (to ? "" : to.error().message));
  return rig_of(*to, loop.test.model);
}

const puppet::Rig& rig(const Clocked& loop) {
  return *loop.test.loop->changes().puppet(loop.test.loop->changes().newest_puppet());
}

template <class List>
std::size_t named(const List& list, std::string_view name) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
  REQUIRE(found != list.end());
  return static_cast<std::size_t>(found - list.begin());
}
template <class List>
bool has_named(const List& list, std::string_view name) {
  return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
}
std::size_t function(const Clocked& loop, std::string_view name) {
  return named(rig(loop).puppet().functions, name);
}
std::size_t point(const Clocked& loop, std::string_view name) {
  return named(rig(loop).puppet().points, name);
}

/// Another function and place of the same fingers.
const char* const other_puppet = R"(
version = 1
model = "ball.obj"
[points]
north = { at = [0.0, 1.0, 0.0], radius = 0.9 }
east = { at = [1.0, 0.0, 0.0], radius = 0.8 }
[functions.growLeft]
input = "left.index_flexion"
travel_deg = 30
curve = "ease"
least = -0.5
move = { north = [0.0, 0.3, 0.0], east = [0.1, 0.0, 0.0] }
)";

/// On a spiral over the ball; every other point is a pin.
std::string puppet_of(int points) {
  std::string text = "version = 1\nmodel = \"ball.obj\"\ndistance = \"air\"\n[points]\n", moves;
  for (int at = 0; at < points; ++at) {
    const double y = 1.0 - (2.0 * at + 1.0) / points, around = 2.399963 * at;
    const double away = std::sqrt(1.0 - y * y);
    const std::string name = "p" + std::to_string(at);
    text += name + " = { at = [" + std::to_string(away * std::cos(around)) + ", " +
            std::to_string(y) + ", " + std::to_string(away * std::sin(around)) +
            "], radius = " + (at % 3 == 0 ? "[0.2, 0.5]" : "0.4") +
            (at % 2 == 0 ? "" : ", pin = true") + " }\n";
    if (at % 2 == 0) moves += (moves.empty() ? "" : ", ") + name + " = [0.0, 0.1, 0.05]";
  }
  return text + "[functions.all]\ninput = \"right.index_flexion\"\ntravel_deg = 30\nmove = { " +
         moves + " }\n";
}

} // namespace

TEST_SUITE("puppet change") {
  TEST_CASE("an edit that changes nothing that acts keeps the shape bit for bit") {
    Clocked loop(Mode::type1, with_puppet), other(Mode::type1, with_puppet);
    other.now = loop.now;
    CHECK(loop.stroke(0, 15) == other.stroke(0, 15));
    const auto once_more = [&](const Result<puppet::Puppet>& to) {
      REQUIRE(loop.test.loop->changes().change_puppet(edited(loop, to)));
      CHECK(loop.bent(15) == other.bent(15));
      CHECK(loop.bent(15) == other.bent(15));
    };
    once_more(puppet::with_name(rig(loop), function(loop, "turn"), "otherTurn"));
    once_more(puppet::with_name(rig(loop), function(loop, "otherTurn"), "turn"));
    once_more(puppet::with_radius(rig(loop), point(loop, "east"), 0.7)); // as it was
    CHECK(loop.test.loop->changes().newest_puppet() == 3);
    CHECK(loop.frame().puppet == 3);
    CHECK(loop.stroke(15, 3) == other.stroke(15, 3));
  }

  TEST_CASE("after an edit the shape is that of a loop that began with the edited puppet") {
    for (const char* distance : {"surface", "air"}) {
      CAPTURE(distance);
      const std::string head = std::string("distance = \"") + distance + "\"\n";
      const std::string from = head + test::ball_puppet, to = head + other_puppet;
      Clocked loop(Mode::type1, {.rings_of_ball = 12, .puppet = from.c_str()});
      Clocked other(Mode::type1, {.rings_of_ball = 12, .puppet = to.c_str()});
      other.now = loop.now;
      loop.stroke(0, 15);
      other.stroke(0, 15);
      const auto puppet = puppet::parse_puppet(to, "to");
      REQUIRE(puppet);
      REQUIRE(loop.test.loop->changes().change_puppet(rig_of(*puppet, loop.test.model)));
      loop.bent(15);
      other.bent(15);
      for (const int counts : {15, 20, 3, 0}) {
        const deform::Points shape = loop.bent(counts);
        CHECK(gap(shape, other.bent(counts)) < 1e-6);
        if (counts == 20) CHECK(gap(shape, loop.test.model.vertices) > 1e-2);
        CHECK(loop.frame().function_count == 1);
      }
      // At rest nothing of the puppet before is left in the model.
      CHECK(gap(loop.bent(0), loop.test.model.vertices) < 1e-6);
    }
  }

  TEST_CASE("undo goes back over edits while hands play on, and redo forth again") {
    Clocked loop(Mode::type1, with_puppet);
    std::vector<deform::Points> shapes;
    const std::array strokes{Eigen::Vector3d(0, -1, 0)};
    loop.stroke(0, 12);
    shapes.push_back(loop.bent(12));
    for (int edit = 0; edit < 6; ++edit) {
      const auto next = [&]() -> Result<puppet::Puppet> {
        switch (edit) {
        case 0:
          return puppet::with_radius(rig(loop), point(loop, "south"), 0.5);
        case 1:
          return puppet::with_move(rig(loop), function(loop, "push"), point(loop, "northLeft"),
                                   {0.2, 0, 0});
        case 2:
          return puppet::with_pin(rig(loop), {{0, 1, 0}, 0.6});
        case 3:
          return puppet::with_masks(rig(loop), strokes, 0.7);
        case 4:
          return puppet::with_name(rig(loop), function(loop, "turn"), "nod");
        default:
          return puppet::with_mirror(rig(loop), false);
        }
      }();
      REQUIRE(loop.test.loop->changes().change_puppet(edited(loop, next)));
      loop.bent(12);
      shapes.push_back(loop.bent(12));
    }
    const auto steps = loop.kinds();
    CHECK(std::count(steps.begin(), steps.end(), StepKind::puppet) ==
          static_cast<int>(loop.test.loop->changes().next_puppet()) - 1);
    const auto settled = [&](Request request) {
      REQUIRE(loop.test.commands.try_push(request));
      loop.bent(12);
      REQUIRE(loop.frame().awaited);
      REQUIRE(loop.test.loop->changes().change_to(*loop.frame().awaited));
      loop.bent(12);
      return loop.bent(12);
    };
    std::size_t at = shapes.size() - 1;
    const std::size_t first = shapes.size() - loop.test.loop->changes().next_puppet();
    for (; at > first; --at)
      CHECK(gap(settled(Request::undo), shapes[at - 1]) < 1e-6);
    CHECK(loop.frame().puppet == 0);
    for (; at + 1 < shapes.size(); ++at)
      CHECK(gap(settled(Request::redo), shapes[at + 1]) < 1e-6);
  }

  TEST_CASE("an undo over an edit leaves the rest shape from which readers of fields continue") {
    const std::string text = std::string("distance = \"air\"\n") + test::ball_puppet;
    Clocked loop(Mode::type1, {.rings_of_ball = 12, .puppet = text.c_str()});
    loop.stroke(0, 12);
    const std::uint64_t rest_changes = loop.frame().rest_changes;
    REQUIRE(loop.test.loop->changes().change_puppet(
        edited(loop, puppet::with_radius(rig(loop), point(loop, "south"), 0.5))));
    loop.bent(12);
    loop.bent(12);
    for (const Request request : {Request::undo, Request::redo}) {
      REQUIRE(loop.test.commands.try_push(request));
      loop.bent(12);
      REQUIRE(loop.frame().awaited);
      REQUIRE(loop.test.loop->changes().change_to(*loop.frame().awaited));
      loop.bent(12);
      CHECK_FALSE(loop.frame().awaited);
      CHECK(loop.frame().rest_changes == rest_changes);
      CHECK(loop.frame().shape_jumps == 0);
    }
    CHECK(loop.frame().undos == 1);
    CHECK(loop.test.loop->stats().redos == 1);
  }

  TEST_CASE("a function that an undo brings back continues as if it had not been away") {
    for (const bool grabs_again : {false, true}) {
      CAPTURE(grabs_again);
      Clocked loop(Mode::type1, with_puppet);
      loop.stroke(0, 12);
      const deform::Points whole = loop.bent(12);
      REQUIRE(rig(loop).puppet().functions.size() > 1);
      // All points that one of the functions moves, so that it goes.
      while (has_named(rig(loop).puppet().functions, "push")) {
        const auto& moves = rig(loop).puppet().functions[function(loop, "push")].moves;
        REQUIRE(loop.test.loop->changes().change_puppet(
            edited(loop, puppet::without_point(rig(loop), moves.front().point))));
        loop.bent(12);
      }
      const deform::Points without = loop.bent(12);
      CHECK(gap(without, whole) > 1e-2);
      const int edits = static_cast<int>(loop.test.loop->changes().newest_puppet());
      if (grabs_again) {
        REQUIRE(loop.test.commands.try_push(Request::regrab));
        loop.bent(12);
      }
      const auto settled = [&](Request request) {
        REQUIRE(loop.test.commands.try_push(request));
        loop.bent(12);
        REQUIRE(loop.frame().awaited);
        REQUIRE(loop.test.loop->changes().change_to(*loop.frame().awaited));
        loop.bent(12);
        return loop.bent(12);
      };
      for (int round = 0; round < 2; ++round) {
        deform::Points shape;
        for (int edit = 0; edit < edits; ++edit)
          shape = settled(Request::undo);
        CHECK(gap(shape, whole) < 1e-6); // bent as it is, the hand plays it as before
        for (int edit = 0; edit < edits; ++edit)
          shape = settled(Request::redo);
        CHECK(gap(shape, without) < 1e-6);
      }
      for (int edit = 0; edit < edits; ++edit)
        settled(Request::undo);
      if (!grabs_again) CHECK(gap(loop.bent(0), loop.test.model.vertices) < 1e-6);
    }
  }

  TEST_CASE("hands that touched the model play a puppet, and touch it again after an undo") {
    Clocked loop(Mode::type1);
    loop.stroke(0, 15);
    const deform::Points shaped = loop.bent(15);
    const auto puppet = puppet::parse_puppet(other_puppet, "other");
    REQUIRE(puppet);
    REQUIRE(loop.test.loop->changes().change_puppet(rig_of(*puppet, loop.test.model)));
    const deform::Points taken = loop.bent(15);
    CHECK(gap(loop.bent(15), taken) < 1e-6); // what was shaped stays
    CHECK(gap(taken, shaped) < 1e-3);
    CHECK(loop.frame().function_count == 1);
    const deform::Points played = loop.bent(25);
    CHECK(gap(played, taken) > 1e-2);
    CHECK(gap(loop.bent(15), taken) < 1e-6);
    REQUIRE(loop.test.commands.try_push(Request::undo));
    loop.bent(15);
    REQUIRE(loop.frame().awaited);
    REQUIRE(loop.test.loop->changes().change_to(*loop.frame().awaited));
    loop.bent(15);
    loop.bent(15);
    CHECK(loop.frame().function_count == 0);
    CHECK(loop.frame().puppet == 0);
    CHECK(gap(loop.bent(25), taken) > 1e-3); // by the fingertips
  }

  TEST_CASE("a puppet that cannot be solved for is refused, and changes nothing") {
    Clocked loop(Mode::type1, with_puppet);
    loop.stroke(0, 10);
    puppet::Puppet puppet = rig(loop).puppet();
    puppet.points.push_back(puppet.points.front());
    puppet.points.back().name = "beside";
    puppet.points.back().at.x() += 1e-9;
    const auto refused = loop.test.loop->changes().change_puppet(rig_of(puppet, loop.test.model));
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == Errc::bad_input);
    CHECK(refused.error().message.find("beside") != std::string::npos);
    CHECK(loop.test.loop->changes().next_puppet() == 1);
    const deform::Points shape = loop.bent(10);
    CHECK(loop.bent(10) == shape);
    CHECK_FALSE(loop.test.loop->changes().change_puppet(std::uint32_t{7}));
    REQUIRE(loop.test.loop->changes().hold_still());
    CHECK_FALSE(loop.test.loop->changes().change_puppet(
        rig_of(*puppet::parse_puppet(other_puppet, "other"), loop.test.model)));
    loop.bent(10);
    loop.test.loop->changes().keep_model();
    loop.bent(10);
    CHECK(loop.test.loop->changes().change_puppet(
        rig_of(*puppet::parse_puppet(other_puppet, "other"), loop.test.model)));
  }

  TEST_CASE("more points than a tick solves for without allocating are refused, unless their field "
            "is ready before") {
    const deform::Mesh model = test::ball(12);
    const auto of = [&](const char* distance, int points) {
      std::string text = puppet_of(points);
      text.replace(text.find("\"air\""), 5, distance);
      const auto read = puppet::parse_puppet(text, "many");
      REQUIRE(read);
      return rig_of(*read, model);
    };
    CHECK(check_points(nullptr));
    CHECK(check_points(of("\"air\"", 100).get()));
    const auto many = of("\"air\"", 101), along = of("\"surface\"", 101);
    CHECK(check_points(along.get()));
    const auto refused = check_points(many.get());
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("101 points") != std::string::npos);
    Clocked loop(Mode::type1, with_puppet);
    CHECK_FALSE(loop.test.loop->changes().change_puppet(many));
    REQUIRE(loop.test.loop->changes().change_puppet(along));
    loop.bent(3);
    LoopSettings settings = loop.test.loop->changes().settings();
    settings.mode = Mode::type2;
    REQUIRE(loop.test.loop->changes().change_settings(settings));
    loop.bent(3);
    CHECK(loop.test.loop->changes().settings().mode == Mode::type2);
    settings.keep_volume = 0.5; // no kernel is known that does along a surface
    CHECK_FALSE(loop.test.loop->changes().change_settings(settings));
    CHECK(loop.test.loop->changes().settings().keep_volume == 0.0);
  }

  TEST_CASE("ticks that take puppets allocate nothing, free nothing, lock nothing") {
    constexpr std::uint64_t ticks = test::rounds(1500);
    test::RestraintCounts sum;
    std::uint32_t puppets = 0;
    const std::string large = puppet_of(60);
    for (unsigned seed = 0; seed < 6; ++seed) {
      InputLog log;
      test::LoopFixture fixture{.rings_of_ball = 6, .input_log = &log};
      if (seed % 2 == 0) fixture.puppet = test::ball_puppet;
      const bool is_large = seed >= 4; // in type 2, whose equations are solved again in each tick
      if (is_large) fixture.puppet = large.c_str();
      const std::size_t most = is_large ? 66 : 10;
      const Mode mode = is_large ? Mode::type2 : Mode::type1;
      test::LoopUnderTest test(mode, fixture);
      test::tick_with_changes(
          test, log, ticks, seed,
          [&](const auto& now, auto& random) {
            return test::any_puppet(now, test.model, random, most);
          },
          sum, is_large ? std::optional(mode) : std::nullopt);
      puppets += test.loop->changes().next_puppet();
    }
    CHECK(sum.allocations == 0);
    CHECK(sum.frees == 0);
    CHECK(sum.locks == 0);
    CHECK(puppets > static_cast<std::uint32_t>(test::rounds(150)));
  }
}

} // namespace puppet_change_test
