// Timelines of hands that play a puppet.

#include <random>

#include <doctest/doctest.h>

#include <nendo/puppet/puppet_edit.hpp>
#include <nendo/recording/loop_replay.hpp>

#include "support/rounds.hpp"
#include "support/takes.hpp"
#include "support/test_meshes.hpp"
#include "support/timelines.hpp"
#include "timeline/edit.hpp"
#include "timeline/edit_history.hpp"
#include "timeline/hand_curve.hpp"
#include "timeline/player.hpp"
#include "timeline/reduce.hpp"
#include "timeline/shape_cache.hpp"
#include "timeline/timeline.hpp"

namespace puppet_timeline_test {

using namespace nendo;
using namespace nendo::timeline;
using deform::Points;
using flow::Mode;

namespace {

constexpr Tolerance none{0.0, 0.0};

/// A recorded run with a puppet, and the shapes of the loop itself.
struct Played {
  test::RecordedLoop live;
  std::vector<Points> shapes;
  std::vector<std::vector<float>> values;

  explicit Played(Mode mode = Mode::type1, const char* puppet = test::ball_puppet)
      : live(mode, hand::FilterKind::off, false, false, flow::SwitchAction::none, puppet) {
    live.record();
  }
  void see(const flow::Frame& frame) {
    shapes.push_back(live.test.vertices_of(frame));
    values.emplace_back(frame.functions.begin(), frame.functions.begin() + frame.function_count);
  }
  MadeTimeline made(const Tolerance& tolerance) {
    REQUIRE(live.end());
    auto timeline = timeline_of_take(live.path, live.test.model, tolerance);
    CAPTURE((timeline ? std::string() : timeline.error().message));
    REQUIRE(timeline);
    return *std::move(timeline);
  }
};

std::unique_ptr<Player> playing(const Timeline& timeline, const deform::Mesh& model) {
  auto player = Player::make(timeline, model);
  CAPTURE((player ? std::string() : player.error().message));
  REQUIRE(player);
  return *std::move(player);
}

Timeline through_text(const Timeline& timeline) {
  const auto text = timeline_text(timeline);
  REQUIRE(text);
  auto read = parse_timeline(*text, "test");
  CAPTURE((read ? std::string() : read.error().message));
  REQUIRE(read);
  CHECK(*timeline_text(*read) == *text);
  return *std::move(read);
}

/// How often a timeline has such an event.
template <class Command>
std::size_t count(const Timeline& timeline) {
  return static_cast<std::size_t>(
      std::count_if(timeline.events.begin(), timeline.events.end(), [](const Event& event) {
        return std::holds_alternative<Command>(event.command);
      }));
}

} // namespace

TEST_SUITE("puppet_timeline") {
  TEST_CASE("with a key for every tick it makes every shape of the take, bit for bit, with hands "
            "and fingers that release, roles and symmetry, also after it has been a file") {
    for (unsigned seed = 0; static_cast<int>(seed) < test::rounds(12); ++seed) {
      CAPTURE(seed);
      std::string text = test::ball_puppet;
      if (seed % 4 == 2) text = "distance = \"air\"" + text;
      Played take(seed % 4 == 3 ? Mode::type2 : Mode::type1, text.c_str());
      test::play(take.live, 300, seed, false, [&](const flow::Frame& frame) { take.see(frame); });
      const Timeline made = take.made(none).timeline;
      CHECK(count<flow::SetClutch>(made) > 3);
      CHECK(count<flow::SetRole>(made) > 3);
      CHECK(count<flow::SetSymmetry>(made) > 3);
      const auto player = playing(through_text(made), take.live.test.model);
      REQUIRE(player->next());
      Points shape;
      std::size_t different = 0;
      double worst = 0.0, most = 0.0;
      for (std::size_t at = 0; at < take.shapes.size(); ++at) {
        REQUIRE(player->next());
        player->layout().unpack(player->frame().shape, shape);
        if (shape != take.shapes[at]) ++different;
        worst = std::max(worst, (shape - take.shapes[at]).cwiseAbs().maxCoeff());
        most = std::max(most, (shape - take.live.test.model.vertices).cwiseAbs().maxCoeff());
      }
      CHECK_FALSE(player->next());
      // A wrist's turn is a quaternion here, and a matrix in the loop. That rounds what a function
      // hears of the place of a tip.
      CHECK(different <= take.shapes.size() / 50);
      CHECK(worst < test::float_gap);
      CHECK(most > 0.01);
    }
  }

  TEST_CASE("a take whose puppet was edited on the way is a timeline with the last puppet") {
    for (const char* distance : {"", "distance = \"air\""}) {
      const std::string text = distance + std::string(test::ball_puppet);
      Played take(Mode::type1, text.c_str());
      auto& test = take.live.test;
      const HostTime begin = HostClock::now();
      const auto now = [&]() -> const puppet::Rig& {
        return *test.loop->changes().puppet(test.loop->changes().newest_puppet());
      };
      const auto edit = [&](const Result<puppet::Puppet>& to) {
        REQUIRE(to);
        REQUIRE(take.live.change_puppet(std::make_shared<const puppet::Rig>(*to, test.model)));
      };
      std::size_t last_edit = 0;
      for (std::uint64_t tick = 0; tick < 160; ++tick) {
        const int bent = static_cast<int>(tick % 40 < 20 ? tick % 20 : 20 - tick % 20);
        test.bend(bent, begin + tick * std::chrono::milliseconds(11));
        if (tick == 45) edit(puppet::with_radius(now(), 1, 0.6));
        if (tick == 60) edit(puppet::with_name(now(), 0, "swellLeft"));
        if (tick == 75)
          test.commands.try_push(flow::SetRole{0, *puppet::HandSignal::named("left.ring_flexion")});
        if (tick == 90) edit(puppet::with_move(now(), 0, 0, {0.3, 0.0, 0.1}));
        if (tick == 105) test.commands.try_push(flow::Request::release);
        if (tick == 108) test.commands.try_push(flow::Request::undo); // of the stroke
        if (tick == 111) test.commands.try_push(flow::Request::undo); // of the edit
        if (tick == 116) test.commands.try_push(flow::Request::grab);
        const flow::Frame& frame = test.frame_after_tick(tick);
        take.see(frame);
        if (frame.awaited) {
          REQUIRE(test.loop->changes().change_to(*frame.awaited));
          last_edit = tick + 2;
        }
      }
      REQUIRE(last_edit > 111);
      const puppet::Puppet last = now().puppet();
      CHECK(last.function_named("swellLeft"));
      const MadeTimeline made = take.made(none);
      CHECK(made.has_last_puppet);
      const Timeline& timeline = made.timeline;
      CHECK(timeline.rig->puppet() == last);
      CHECK(count<flow::SetRole>(timeline) == 1);
      CHECK(count<flow::Request>(timeline) == 3); // the edit's undo is none here
      const auto player = playing(through_text(timeline), test.model);
      REQUIRE(player->next());
      Points shape;
      double before = 0.0, after = 0.0;
      for (std::size_t at = 0; at < take.shapes.size(); ++at) {
        REQUIRE(player->next());
        player->layout().unpack(player->frame().shape, shape);
        double& worst = at >= last_edit ? after : before;
        worst = std::max(worst, (shape - take.shapes[at]).cwiseAbs().maxCoeff());
      }
      CHECK(after < test::float_gap);
      CHECK(before > 1e-2);
    }
  }

  TEST_CASE("so it does, without a single bit of difference, where functions listen to angles, and "
            "settings change on the way") {
    std::size_t changes = 0;
    for (unsigned seed = 0; static_cast<int>(seed) < test::rounds(6); ++seed) {
      CAPTURE(seed);
      std::string text = test::ball_puppet;
      text.replace(text.find("right.ring_tip_z"), 16, "right.ring_flexion");
      text.replace(text.find("travel_m = 0.02"), 15, "travel_deg = 20");
      Played take(seed % 3 == 2 ? Mode::type2 : Mode::type1, text.c_str());
      auto& test = take.live.test;
      std::mt19937 random(seed);
      const HostTime begin = HostClock::now();
      int bent = 0;
      for (std::uint64_t tick = 0; tick < 200; ++tick) {
        bent = std::clamp(bent + static_cast<int>(random() % 5) - 2, 0, 30);
        test.bend(bent, begin + tick * std::chrono::milliseconds(11));
        flow::LoopSettings settings = test::any_settings(test.loop->changes().settings(), random);
        settings.filter = test.loop->changes().settings().filter;
        settings.injective = false;
        if (settings.mode == Mode::clay) settings.mode = Mode::type2; // clay takes no puppet
        if (tick % 15 == 9) static_cast<void>(test.loop->changes().change_settings(settings));
        const flow::Command role = test::any_role(random);
        const auto* input = std::get_if<flow::SetRole>(&role);
        if (random() % 8 == 0 && (input == nullptr || input->input.is_angle()))
          test.commands.try_push(role);
        if (random() % 30 == 0) test.commands.try_push(flow::Mark{});
        if (tick % 8 == 0) test.commands.try_push(flow::requests[random() % flow::requests.size()]);
        const flow::Frame& frame = take.live.test.frame_after_tick(tick);
        take.see(frame);
        if (frame.awaited) static_cast<void>(test.loop->changes().change_to(*frame.awaited));
      }
      const Timeline made = take.made(none).timeline;
      CHECK(count<flow::Mark>(made) > 2);
      const auto player = playing(through_text(made), test.model);
      REQUIRE(player->next());
      Points shape;
      std::size_t different = 0;
      for (const Points& wanted : take.shapes) {
        REQUIRE(player->next());
        player->layout().unpack(player->frame().shape, shape);
        if (shape != wanted) ++different;
      }
      CHECK(different == 0);
      CHECK(player->final_shape() == test.loop->final_shape());
      CHECK(player->stats().changes == test.loop->stats().changes);
      changes += count<flow::ChangeSettings>(made);
    }
    CHECK(changes > 5 * static_cast<std::size_t>(test::rounds(6)));
  }

  TEST_CASE(
      "with few keys no point of the puppet is farther off than the tolerance, in any frame") {
    std::size_t keys = 0, frames = 0;
    double max_m = 0.0;
    for (unsigned seed = 0; static_cast<int>(seed) < test::rounds(6); ++seed) {
      CAPTURE(seed);
      std::string text = test::symmetric_puppet;
      // While one hand plays both sides, the greater of two values counts, which jumps where they
      // have different signs.
      text.erase(text.find("least = -0.5"), 12);
      Played take(Mode::type1, text.c_str());
      std::mt19937 random(seed);
      const HostTime begin = HostClock::now();
      for (std::uint64_t tick = 0; tick < 300; ++tick) {
        const double phase = 6.28 * static_cast<double>(tick) / 150.0;
        take.live.test.bend(static_cast<int>(15.0 - 15.0 * std::cos(phase)),
                            begin + tick * std::chrono::milliseconds(11));
        if (tick % 30 == 17) take.live.test.commands.try_push(test::any_role(random));
        if (tick % 70 == 40) take.live.test.commands.try_push(flow::Request::release);
        if (tick % 70 == 60) take.live.test.commands.try_push(flow::Request::grab);
        take.see(take.live.test.frame_after_tick(tick));
      }
      constexpr double tolerance_m = 8e-3;
      Tolerance tolerance;
      tolerance.point_m = tolerance_m;
      const MadeTimeline made = take.made(tolerance);
      const auto player = playing(made.timeline, take.live.test.model);
      const puppet::Rig& rig = *take.live.test.options.rig;
      REQUIRE(player->next());
      for (const auto& values : take.values) {
        REQUIRE(player->next());
        const flow::Frame& frame = player->frame();
        Points wanted, points;
        rig.place(std::vector<double>(values.begin(), values.end()), wanted);
        rig.place(std::vector<double>(frame.functions.begin(),
                                      frame.functions.begin() + frame.function_count),
                  points);
        max_m = std::max(max_m, (points - wanted).colwise().norm().maxCoeff() /
                                    made.timeline.units_per_metre);
      }
      CHECK(max_m <= tolerance_m + 1e-6);
      for (const Reduction& hand : made.hands) {
        CHECK(hand.worst.point_m <= tolerance_m / 2.0);
        frames += hand.frames;
      }
      keys += made.timeline.key_count();
    }
    MESSAGE(keys << " keys of " << frames << " frames; a point is off by at most " << 1e3 * max_m
                 << " mm");
    CHECK(keys < frames / 2);
    CHECK(max_m > 1e-4); // it is not all keys
  }

  TEST_CASE("the functions alone have the values of the player, at frames and wherever keys are") {
    for (unsigned seed = 0; static_cast<int>(seed) < test::rounds(6); ++seed) {
      CAPTURE(seed);
      Played take;
      test::play(take.live, 200, seed);
      const Timeline made = take.made({.tip_m = 2e-3}).timeline;
      const auto player = playing(made, take.live.test.model);
      std::vector<double> times_s;
      for (std::uint64_t frame = 0; frame < player->frame_count(); ++frame)
        times_s.push_back(static_cast<double>(frame) / made.rate_hz);
      std::size_t seen = 0, different = 0;
      play_functions(made, times_s, [&](std::size_t at, const PuppetMoment& moment) {
        CHECK(at == seen++);
        REQUIRE(player->next());
        const auto values = moment.hands.player().values();
        for (std::size_t function = 0; function < values.size(); ++function)
          if (static_cast<float>(values[function]) != player->frame().functions[function])
            ++different;
      });
      CHECK(seen == player->frame_count());
      CHECK(different == 0);
    }
  }

  TEST_CASE(
      "mirrored, each function has the value of its twin, and so the shape is the mirrored one "
      "of the mirrored model") {
    const deform::Mesh model = test::sphere(12, 24, 1.0);
    const Timeline before = test::puppet_timeline(model);
    deform::Mesh mirrored_model = model;
    mirrored_model.vertices.row(0) = -model.vertices.row(0);
    Timeline after = before;
    REQUIRE(mirror(after, 0.0));
    CHECK(after.rig_state.functions != before.rig_state.functions); // jawOpen is the left thumb's
    const auto one = playing(before, model);
    const auto other = playing(after, mirrored_model);
    const puppet::Puppet& puppet = before.rig->puppet();
    Points shape, twin;
    double most = 0.0, apart = 0.0, worst = 0.0;
    while (one->next()) {
      REQUIRE(other->next());
      for (std::size_t at = 0; at < puppet.functions.size(); ++at) {
        const auto twin_at = puppet.function_named(puppet::twin_of(puppet.functions[at].name));
        CHECK(one->frame().functions[at] == other->frame().functions[twin_at.value_or(at)]);
      }
      one->layout().unpack(one->frame().shape, shape);
      other->layout().unpack(other->frame().shape, twin);
      twin.row(0) = -twin.row(0).eval();
      worst = std::max(worst, (twin - shape).cwiseAbs().maxCoeff());
      most = std::max(most, (shape - model.vertices).cwiseAbs().maxCoeff());
      apart = std::max(apart, static_cast<double>(std::abs(one->frame().functions[3] -
                                                           other->frame().functions[3])));
    }
    CHECK(worst < test::float_gap);
    CHECK(most > 0.05);
    CHECK(apart > 0.05); // the sides differ
    // Twice is once back.
    REQUIRE(mirror(after, 0.0));
    CHECK(test::same_bits(after, before));
  }

  TEST_CASE("a function that listens to a tip's way to the side has the same values mirrored") {
    const deform::Mesh model = test::sphere(6, 8, 1.0);
    Timeline before = test::puppet_timeline(model, 30);
    for (const std::string hand : {"left", "right"}) {
      before.rig_state.functions[0].input = *puppet::HandSignal::named(hand + ".index_tip_x");
      Timeline after = before;
      REQUIRE(mirror(after, 0.0));
      const auto one = playing(before, model), other = playing(after, model);
      const puppet::Puppet& puppet = before.rig->puppet();
      const std::size_t twin =
          puppet.function_named(puppet::twin_of(puppet.functions[0].name)).value_or(0);
      float most = 0.0F;
      while (one->next()) {
        REQUIRE(other->next());
        CHECK(std::abs(one->frame().functions[0] - other->frame().functions[twin]) < 1e-6F);
        most = std::max(most, std::abs(one->frame().functions[0]));
      }
      CHECK(most > 1e-4F);
    }
  }

  TEST_CASE("a mirror and other edits are undone and redone, bit for bit") {
    const Timeline first = test::puppet_timeline(test::sphere(6, 8, 1.0));
    EditHistory history(first);
    const auto apply = [&](const std::function<Result<void>(Timeline&)>& edit) {
      REQUIRE(history.apply([&](Timeline& timeline) -> Result<std::optional<KeyRef>> {
        if (const auto done = edit(timeline); !done) return done.error();
        return std::optional<KeyRef>();
      }));
    };
    std::vector<Timeline> states{first};
    const auto then = [&](const std::function<Result<void>(Timeline&)>& edit) {
      apply(edit);
      states.push_back(history.timeline());
    };
    then([](Timeline& timeline) { return mirror(timeline, 0.1); });
    then([](Timeline& timeline) { return move_key(timeline, Side::left, 3, 0.33); });
    then([](Timeline& timeline) -> Result<void> {
      const auto set = set_value(timeline, "jawOpen", 5, 0.4);
      return set ? Result<void>() : Result<void>(set.error());
    });
    then([](Timeline& timeline) { return retime(timeline, 2.0, 0.2, 0.5); });
    then([](Timeline& timeline) { return mirror(timeline, 0.1); });
    for (std::size_t at = states.size(); at-- > 1;) {
      CHECK_FALSE(test::same_bits(states[at], states[at - 1]));
      REQUIRE(history.undo());
      CHECK(test::same_bits(history.timeline(), states[at - 1]));
    }
    CHECK_FALSE(history.undo());
    for (std::size_t at = 1; at < states.size(); ++at) {
      REQUIRE(history.redo());
      CHECK(test::same_bits(history.timeline(), states[at]));
    }
  }

  TEST_CASE("frames before a change are kept, and none after a mirror") {
    const Timeline before = test::puppet_timeline(test::sphere(6, 8, 1.0));
    Timeline after = before;
    after.events[2].time_s += 0.01; // of 0.3 s
    CHECK(unchanged_frames(before, 90, after, 90, 90) == 26);
    REQUIRE(mirror(after, 0.0));
    CHECK(unchanged_frames(before, 90, after, 90, 90) == 0);
  }

  TEST_CASE("a set value is the function's at that key, and only its finger is bent") {
    const deform::Mesh model = test::sphere(12, 24, 1.0);
    Timeline timeline = test::puppet_timeline(model);
    timeline.events.clear();
    for (const double value : {0.0, 0.3, 0.69, 0.71, 0.95, 1.0}) {
      CAPTURE(value);
      const Timeline before = timeline;
      const auto set = set_value(timeline, "jawOpen", 4, value);
      CAPTURE((set ? std::string() : set.error().message));
      REQUIRE(set);
      CHECK(set->key == KeyRef{Side::right, 4});
      CHECK(set->value == doctest::Approx(value));
      const Key& key = timeline.hands[1].keys[4];
      const Key& was = before.hands[1].keys[4];
      Key rest = key;
      rest.angles.thumb_mcp_flexion_rad = was.angles.thumb_mcp_flexion_rad;
      rest.angles.thumb_ip_flexion_rad = was.angles.thumb_ip_flexion_rad;
      CHECK(timeline::same_bits(rest, was));
      const auto player = playing(timeline, model);
      while (player->next() && player->time_s() < key.time_s - 1e-9) {
      }
      CHECK(static_cast<double>(player->frame().functions[1]) ==
            doctest::Approx(value)); // frownLeft, jawOpen
    }
    timeline.rig_state.functions[1].input = *puppet::HandSignal::named("right.index_tip_z");
    std::string text = test::symmetric_puppet;
    const auto refused = [&](const char* function, std::size_t key, double value) {
      const Timeline before = timeline;
      const auto set = set_value(timeline, function, key, value);
      REQUIRE_FALSE(set);
      CHECK(set.error().code == Errc::usage);
      CHECK(test::same_bits(timeline, before));
      return set.error().message;
    };
    CHECK(refused("jawopen", 1, 0.5).find("no function 'jawopen'") != std::string::npos);
    CHECK(refused("pucker", 1, 1.5).find("from 0 to 1") != std::string::npos);
    CHECK(refused("pucker", 99, 0.5).find("key 99") != std::string::npos);
    CHECK(refused("pucker", 0, 0.5).find("grabs") != std::string::npos);
    CHECK(refused("frownLeft", 4, 2.0).find("ends where") != std::string::npos); // -60 degrees
    timeline.events = {{0.1, flow::SetClutch{Side::left, 0, false}}};
    CHECK(refused("pucker", 4, 0.5).find("released") != std::string::npos);
    timeline.events = {{0.1, flow::Request::release}};
    CHECK(refused("pucker", 4, 0.5).find("released") != std::string::npos);
    timeline.rig.reset();
    timeline.rig_state = {};
    CHECK(refused("pucker", 4, 0.5).find("no puppet") != std::string::npos);
  }

  TEST_CASE("what was asked for is the least that gives a value") {
    const puppet::Puppet puppet = *puppet::parse_puppet(test::symmetric_puppet, "test");
    for (const puppet::Function& function : puppet.functions)
      for (double part = -1.0; part <= 1.0; part += 0.01) {
        const double value = part * (part < 0.0 ? -function.least : function.most);
        const double asked = puppet::asked_for(function, value);
        CHECK(puppet::value_of(function, asked) == doctest::Approx(value).epsilon(1e-9));
        CHECK(std::abs(asked) >= std::abs(value) - 1e-12);
      }
  }

  TEST_CASE("what is wrong with a puppet in a file is said with its line") {
    const Timeline made = test::puppet_timeline(test::sphere(6, 8, 1.0), 30);
    const std::string text = *timeline_text(made);
    CHECK(test::same_bits(*parse_timeline(text, "fine"), made));
    const auto complaint = [&](const std::string& part, const std::string& other) {
      const auto at = text.find(part);
      REQUIRE(at != std::string::npos);
      const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
      std::string bad = text;
      bad.replace(at, part.size(), other);
      const auto parsed = parse_timeline(bad, "bad");
      REQUIRE_FALSE(parsed);
      const std::string message = parsed.error().message;
      CAPTURE(message);
      CHECK(parsed.error().code == Errc::bad_input);
      CHECK(message.starts_with("bad:" + std::to_string(line) + ": "));
      CHECK(message.find('\n') == std::string::npos);
      return message;
    };
    CHECK(complaint("travel_deg = -30", "travel_deg = x").find("puppet's text") !=
          std::string::npos);
    CHECK(complaint("pin = true }", "pin = 1 }").find("pin") != std::string::npos);
    CHECK(complaint("move = { cornerLeft = [0.15", "move = { nose = [0.15").find("'nose'") !=
          std::string::npos);
    CHECK(complaint("role = { function = \"pucker\"", "role = { function = \"puker\"")
              .find("no function 'puker'") != std::string::npos);
    CHECK(complaint("name = \"jawOpen\"", "name = \"jaw\"").find("no function 'jaw'") !=
          std::string::npos);
    CHECK(complaint("input = \"left.palm_arch\"", "input = \"left.nose\"").find("left.nose") !=
          std::string::npos);
    CHECK(complaint("finger = \"palm\"", "finger = \"toe\"").find("toe") != std::string::npos);
    CHECK(complaint("symmetric = true", "symmetric = 1").find("symmetric") != std::string::npos);
    CHECK(complaint("crown = [", "nose = [").find("no point 'nose'") != std::string::npos);
  }

  TEST_CASE("whatever is done to its bytes, it is refused, or can be written and played") {
    std::mt19937 random(4);
    const deform::Mesh model = test::sphere(6, 8, 1.0);
    const std::string text = *timeline_text(test::puppet_timeline(model, 12));
    for (int round = 0; round < 1500; ++round) {
      std::string bytes = text;
      for (auto turns = 1 + random() % 3; turns > 0; --turns)
        bytes[random() % std::min<std::size_t>(bytes.size(), 4500)] =
            static_cast<char>(random() % 2 == 0 ? random() % 256 : '0' + random() % 10);
      const auto parsed = parse_timeline(bytes, "bytes");
      if (!parsed) {
        CHECK(parsed.error().message.starts_with("bytes:"));
        CHECK(parsed.error().message.find('\n') == std::string::npos);
        continue;
      }
      CHECK(complaint_about(*parsed).empty());
      CHECK(timeline_text(*parsed));
      if (parsed->duration_s > 10.0 || parsed->rate_hz > 1000.0) continue;
      const auto player = Player::make(*parsed, model);
      while (player && (*player)->next()) {
      }
      if (player) CHECK((*player)->final_shape().allFinite());
    }
  }

  TEST_CASE("a puppet of another model is refused, and so are commands without a puppet") {
    Timeline made = test::puppet_timeline(test::sphere(6, 8, 1.0), 12);
    puppet::Puppet puppet = made.rig->puppet();
    puppet.points[1].vertex = 5000;
    made.rig = std::make_shared<const puppet::Rig>(puppet, made.rig->starts());
    const auto refused = Player::make(made, test::sphere(6, 8, 1.0));
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("vertex 5000") != std::string::npos);
    CHECK(refused.error().message.find("does not fit") != std::string::npos);
    made.rig.reset();
    made.rig_state = {};
    made.sculptor.deformer.supports = deform::one_radius(0.5);
    CHECK(complaint_about(made).find("event 0") != std::string::npos);
    made.events.clear();
    CHECK(complaint_about(made).empty());
  }
}

} // namespace puppet_timeline_test
