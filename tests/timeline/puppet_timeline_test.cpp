// Timelines of hands that play a puppet.

#include <random>

#include <doctest/doctest.h>

#include <nendo/recording/loop_replay.hpp>

#include "support/rounds.hpp"
#include "support/takes.hpp"
#include "support/timelines.hpp"
#include "timeline/from_take.hpp"
#include "timeline/player.hpp"
#include "timeline/timeline_file.hpp"

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
            "and fingers that let go, roles and symmetry, also after it has been a file") {
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
      CHECK(most > 0.02);
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
        flow::LoopSettings settings = test::any_settings(test.loop->settings(), random);
        settings.filter = test.loop->settings().filter;
        settings.injective = false;
        if (tick % 15 == 9) test.loop->change_settings(settings);
        const flow::Command role = test::any_role(random);
        const auto* input = std::get_if<flow::SetRole>(&role);
        if (random() % 8 == 0 && (input == nullptr || input->input.is_angle()))
          test.commands.try_push(role);
        if (random() % 30 == 0) test.commands.try_push(flow::Mark{});
        if (tick % 8 == 0) test.commands.try_push(flow::requests[random() % flow::requests.size()]);
        const flow::Frame& frame = take.live.test.frame_after_tick(tick);
        take.see(frame);
        if (frame.awaited) test.loop->change_to(*frame.awaited);
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
    CHECK(changes > 10);
  }
}

} // namespace puppet_timeline_test
