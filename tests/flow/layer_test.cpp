// Takes in layers: the laws of a layer, and of the script that plays below it.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/flow/hand_input.hpp>

#include "support/layered_loop.hpp"
#include "support/restraint.hpp"

namespace layer_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::flow;
using test::LayeredLoop;
using test::LoopUnderTest;
using test::performance;

namespace {

constexpr std::uint64_t ticks = 240;
constexpr HostTime begin{std::chrono::seconds(1000)};

struct Seen {
  deform::Points vertices;
  std::array<hand::JointAngles, 2> angles;
};

/// Plays hands in `rings` by their performances, and keeps what every tick showed.
struct Player {
  const LoopUnderTest& like;
  LayeredLoop& played;
  std::vector<std::pair<SampleRing*, Side>> hands;
  std::vector<test::Performance> performances;

  Seen tick(std::uint64_t number) {
    const HostTime now = TickGrid(begin, LayeredLoop::rate_hz).deadline(number);
    for (std::size_t at = 0; at < hands.size(); ++at)
      hands[at].first->try_push(
          test::bent_sample(hands[at].second, performances[at](number), now - 1ms));
    const Frame& frame = played.tick(number, begin);
    Seen seen;
    played.loop->changes().layout(frame.model).unpack(frame.shape, seen.vertices);
    for (std::size_t slot = 0; slot < 2; ++slot)
      seen.angles[slot] = frame.hands[slot].angles;
    return seen;
  }
  std::vector<Seen> all() {
    std::vector<Seen> seen;
    for (std::uint64_t number = 0; number < ticks; ++number)
      seen.push_back(tick(number));
    return seen;
  }
};

bool same(const std::vector<Seen>& one, const std::vector<Seen>& other) {
  return std::equal(
      one.begin(), one.end(), other.begin(), other.end(), [](const Seen& a, const Seen& b) {
        return a.vertices == b.vertices && test::same_angles(a.angles[0], b.angles[0]) &&
               test::same_angles(a.angles[1], b.angles[1]);
      });
}

/// Both hands by two seeds, as one take.
std::vector<Seen> take_of(LoopUnderTest& like, LayeredLoop& played, unsigned seed) {
  Player player{like,
                played,
                {{like.rings[0].get(), Side::left}, {like.rings[1].get(), Side::right}},
                {performance(seed), performance(seed + 1)}};
  return player.all();
}

AngleSet only(const char* part) {
  return *angles_named(part);
}

} // namespace

TEST_SUITE("layer") {
  TEST_CASE("parts of hands are named, and nothing else is") {
    const auto both = parse_layer("left.index,right");
    REQUIRE(both);
    CHECK((*both)[1] == AngleSet::all());
    for (std::size_t at = 0; at < hand::angle_count; ++at) {
      const auto angle = hand::angle_at(at);
      CHECK((*both)[0].has(angle) == name_of(angle).starts_with("index_"));
    }
    std::uint32_t parts = 0;
    for (const char* part : {"thumb", "index", "middle", "ring", "little", "palm", "wrist"}) {
      CHECK((parts & only(part).bits) == 0);
      parts |= only(part).bits;
    }
    CHECK(parts == AngleSet::all().bits);
    CHECK(only("wrist_yaw").bits == 1U << hand::index_of(hand::Angle::wrist_yaw));
    for (const char* text : {"", "up", "left.", "left.toe", "left,", ",left", "left.index.",
                             "left.in", "left index", "LEFT"})
      CHECK_FALSE(parse_layer(text).has_value());
  }

  TEST_CASE("a layer of no joints leaves the take as it was, bit for bit, in both types") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      for (const auto filter : {hand::FilterKind::off, hand::FilterKind::one_euro}) {
        LoopUnderTest like(mode, {.rings_of_ball = 12, .filter = filter});
        LayeredLoop first(like, like.inputs);
        const auto seen = take_of(like, first, 1);
        const auto script = first.script_so_far();
        SampleRing live(64);
        HandInput none = test::layer_of(like.inputs[0], {});
        none.ring = &live;
        LayeredLoop again(like,
                          {test::scripted(like.inputs[0]), test::scripted(like.inputs[1]), none},
                          script.get());
        Player player{like, again, {{&live, Side::left}}, {performance(7)}};
        CHECK(same(player.all(), seen));
        CHECK(script->has_ended());
      }
    }
  }

  TEST_CASE("a layer of all joints is that hand, bit for bit") {
    LoopUnderTest like(Mode::type2, {.rings_of_ball = 12});
    LayeredLoop first(like, like.inputs);
    take_of(like, first, 1);
    const auto script = first.script_so_far();
    LayeredLoop live(like, like.inputs);
    const auto seen = take_of(like, live, 5);
    LayeredLoop over(like,
                     {test::scripted(like.inputs[0]), test::scripted(like.inputs[1]),
                      test::layer_of(like.inputs[0], AngleSet::all()),
                      test::layer_of(like.inputs[1], AngleSet::all())},
                     script.get());
    CHECK(same(take_of(like, over, 5), seen));
  }

  TEST_CASE("left first and then right is both at once, bit for bit, with a puppet, too") {
    for (const char* puppet : {static_cast<const char*>(nullptr), test::ball_puppet}) {
      LoopUnderTest like(Mode::type1, {.rings_of_ball = 12, .puppet = puppet});
      LayeredLoop both(like, like.inputs);
      const auto seen = take_of(like, both, 3);
      LayeredLoop left(like, {like.inputs[0]});
      Player first{like, left, {{like.rings[0].get(), Side::left}}, {performance(3)}};
      first.all();
      const auto script = left.script_so_far();
      LayeredLoop then(
          like, {test::scripted(like.inputs[0]), test::layer_of(like.inputs[1], AngleSet::all())},
          script.get());
      Player second{like, then, {{like.rings[1].get(), Side::right}}, {performance(4)}};
      CHECK(same(second.all(), seen));
    }
  }

  TEST_CASE("some fingers over others: each joint is its own layer's, bit for bit") {
    LoopUnderTest like(Mode::type1, {.rings_of_ball = 12});
    LayeredLoop base(like, like.inputs);
    const auto below = take_of(like, base, 1);
    const auto script = base.script_so_far();
    LayeredLoop live(like, like.inputs);
    const auto above = take_of(like, live, 5);
    LayeredLoop over(like,
                     {test::scripted(like.inputs[0]), test::scripted(like.inputs[1]),
                      test::layer_of(like.inputs[0], only("ring"))},
                     script.get());
    Player player{like, over, {{like.rings[0].get(), Side::left}}, {performance(5)}};
    const auto seen = player.all();
    bool differs = false;
    for (std::size_t tick = 0; tick < seen.size(); ++tick) {
      for (std::size_t at = 0; at < hand::angle_count; ++at) {
        const auto angle = hand::angle_at(at);
        const bool is_ring = name_of(angle).starts_with("ring_");
        CHECK(seen[tick].angles[0][angle] == (is_ring ? above : below)[tick].angles[0][angle]);
        differs = differs || above[tick].angles[0][angle] != below[tick].angles[0][angle];
      }
      CHECK(test::same_angles(seen[tick].angles[1], below[tick].angles[1]));
    }
    CHECK(differs);
  }

  TEST_CASE("punching in and out blends: no tick leaps, and before and behind it is exact") {
    LoopUnderTest like(Mode::type1, {.rings_of_ball = 12});
    LayeredLoop base(like, like.inputs);
    Player still{like,
                 base,
                 {{like.rings[0].get(), Side::left}, {like.rings[1].get(), Side::right}},
                 {[](auto) { return 0; }, [](auto) { return 0; }}};
    const auto below = still.all();
    const auto script = base.script_so_far();
    script->add(500ms, SetLayer{2, true});
    script->add(1500ms, SetLayer{2, false});
    LayeredLoop over(like,
                     {test::scripted(like.inputs[0]), test::scripted(like.inputs[1]),
                      test::layer_of(like.inputs[0], AngleSet::all(), false)},
                     script.get());
    Player player{like, over, {{like.rings[0].get(), Side::left}}, {[](auto) { return 25; }}};
    const auto seen = player.all();
    const auto bend = [&](std::size_t tick) {
      return seen[tick].angles[0][hand::Angle::index_mcp_flexion];
    };
    const double low = bend(40), high = bend(100), whole = high - low;
    CHECK(whole > 0.2);
    for (std::size_t tick = 0; tick < seen.size(); ++tick) {
      if (tick < 50 || tick >= 165) {
        CHECK(test::same_angles(seen[tick].angles[0], below[tick].angles[0]));
      } else if (tick >= 65 && tick < 150) {
        CHECK(bend(tick) == high);
      }
      // The blend's greatest speed is 1.5 of its mean, and 10 ms are 1/15 of its time.
      if (tick > 0) CHECK(std::abs(bend(tick) - bend(tick - 1)) <= 1.5 / 15.0 * whole + 1e-12);
    }
    CHECK(bend(57) > low + 0.2 * whole);
    CHECK(bend(57) < high - 0.2 * whole);
  }

  TEST_CASE("without a hand below, what a layer does not play rests as it was at first") {
    LoopUnderTest like(Mode::type1, {.rings_of_ball = 12});
    LayeredLoop alone(like, {test::layer_of(like.inputs[0], only("index"))});
    Player player{like, alone, {{like.rings[0].get(), Side::left}}, {performance(2)}};
    LayeredLoop whole(like, {like.inputs[0]});
    Player all{like, whole, {{like.rings[0].get(), Side::left}}, {performance(2)}};
    const hand::JointAngles rest =
        hand::joint_angles(like.inputs[0].first, hand::default_calibration());
    const auto seen = player.all();
    const auto hands = all.all();
    for (std::size_t tick = 0; tick < seen.size(); ++tick)
      for (std::size_t at = 0; at < hand::angle_count; ++at) {
        const auto angle = hand::angle_at(at);
        const bool plays = name_of(angle).starts_with("index_");
        CHECK(seen[tick].angles[0][angle] == (plays ? hands[tick].angles[0] : rest)[angle]);
      }
  }

  TEST_CASE("a take that repeats continues in time, from where it was") {
    LoopUnderTest like(Mode::type1, {.rings_of_ball = 12});
    LayeredLoop base(like, like.inputs);
    take_of(like, base, 1);
    const auto script = base.script_so_far();
    script->repeat({400ms, 1200ms});
    LayeredLoop again(like, {test::scripted(like.inputs[0]), test::scripted(like.inputs[1])},
                      script.get());
    std::vector<Seen> seen;
    Player player{like, again, {}, {}};
    for (std::uint64_t tick = 0; tick < 600; ++tick)
      seen.push_back(player.tick(tick));
    CHECK_FALSE(script->has_ended());
    // A round of 80 ticks, after its departure.
    for (std::size_t tick = 80 + 140; tick < 80 + 200; ++tick)
      CHECK(test::same_angles(seen[tick].angles[0], seen[tick - 80].angles[0]));
    std::array<GloveSample, 2> last{};
    again.log.drain([&](const InputLogEntry& entry) noexcept {
      const auto* taken = std::get_if<TakenSample>(&entry);
      if (taken == nullptr) return;
      GloveSample& before = last[taken->hand];
      if (before.sequence > 0 || before.arrival > HostTime{}) {
        CHECK(taken->sample.arrival >= before.arrival);
        CHECK(taken->sample.sequence >= before.sequence + 1);
        const int leap = taken->sample.raw[4].value - before.raw[4].value;
        CHECK(std::abs(leap) <= 4); // the hand's own way and the blend's
      }
      before = taken->sample;
    });
  }

  TEST_CASE("what a script leaves to others, and the full ring refuses, is counted") {
    const std::vector<InputScript::Event> events(300, {{}, Command(Subdivide{})});
    InputScript script(events, begin, 1s);
    script.play({}, [](const InputLogEntry&) noexcept { CHECK(false); });
    CHECK(script.for_others().size() + script.for_others().counters().refused == events.size());
    CHECK(script.for_others().counters().refused > 0);
  }

  TEST_CASE("inputs of which no loop can be made are known") {
    LoopUnderTest like(Mode::type1, {.rings_of_ball = 12});
    const HandInput left = like.inputs[0], right = like.inputs[1];
    const HandInput layer = test::layer_of(left, AngleSet::all());
    const auto fits = [](const std::vector<HandInput>& inputs) {
      return static_cast<bool>(check_inputs(inputs));
    };
    CHECK(fits({left}));
    CHECK(fits({right, left, layer, layer}));
    CHECK(fits({layer}));
    CHECK(fits({left, layer, right}));
    CHECK_FALSE(fits({}));
    CHECK_FALSE(fits({left, left}));
    CHECK(
        check_inputs(std::vector{right, left, left}).error().message ==
        "input 2 of a loop: the left hand has an input before; make this a layer, or leave it out");
    CHECK_FALSE(fits({layer, left}));
    std::vector<HandInput> many{left};
    many.resize(max_inputs, layer);
    CHECK(fits(many));
    CHECK(count_hands(many) == 1);
    many.push_back(layer);
    CHECK_FALSE(fits(many));
  }

  TEST_CASE("a tick with a script and layers allocates nothing") {
    LoopUnderTest like(Mode::type2, {.rings_of_ball = 12, .puppet = test::ball_puppet});
    LayeredLoop base(like, like.inputs);
    take_of(like, base, 1);
    const auto script = base.script_so_far();
    script->repeat({400ms, 1200ms});
    std::vector<HandInput> inputs{test::scripted(like.inputs[0]), test::scripted(like.inputs[1])};
    for (std::size_t at = 2; at < max_inputs; ++at) {
      const auto& hand = like.inputs[at % 2];
      inputs.push_back(test::layer_of(at < 4 ? hand : test::scripted(hand), only("ring")));
      script->add(300ms * at, SetLayer{static_cast<std::uint8_t>(at), at % 3 == 0});
    }
    LayeredLoop over(like, inputs, script.get());
    const HostTime now = HostClock::now();
    test::RestraintCounts counts;
    for (std::uint64_t tick = 0; tick < 1000; ++tick) {
      for (std::size_t at = 0; at < 2; ++at)
        like.rings[at]->try_push(test::bent_sample(at == 0 ? Side::left : Side::right,
                                                   performance(3)(tick), now + tick * 10ms));
      over.commands.try_push(SetLayer{2, tick % 40 < 20});
      const test::Restraint restraint;
      over.loop->tick(tick, TickGrid(now, LayeredLoop::rate_hz).deadline(tick));
      counts.allocations += restraint.counts().allocations;
      counts.frees += restraint.counts().frees;
      counts.locks += restraint.counts().locks;
    }
    CHECK(counts.allocations == 0);
    CHECK(counts.frees == 0);
    CHECK(counts.locks == 0);
  }
}

} // namespace layer_test
