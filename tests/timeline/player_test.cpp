#include <random>

#include <doctest/doctest.h>

#include <nendo/recording/loop_replay.hpp>

#include "support/rounds.hpp"
#include "support/takes.hpp"
#include "timeline/edit.hpp"
#include "timeline/player.hpp"
#include "timeline/reduce.hpp"
#include "timeline/timeline.hpp"

namespace player_test {

using namespace nendo;
using namespace nendo::timeline;
using deform::Points;
using flow::Mode;

namespace {

double farthest(const Points& one, const Points& other) {
  return (one - other).colwise().norm().maxCoeff();
}

std::unique_ptr<Player> playing(const Timeline& timeline, const deform::Mesh& model) {
  auto player = Player::make(timeline, model);
  CAPTURE((player ? std::string() : player.error().message));
  REQUIRE(player);
  return *std::move(player);
}

/// A recorded run, with or without what people ask for.
struct Taken {
  test::RecordedLoop live;
  explicit Taken(Mode mode, bool injective = false,
                 flow::SwitchAction action = flow::SwitchAction::none)
      : live(mode, hand::FilterKind::off, false, injective, action) {
    live.record();
  }
  /// Hands that close slowly, and open.
  void bend(std::uint64_t ticks) {
    const HostTime begin = HostClock::now();
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      const double phase = 6.28 * static_cast<double>(tick) / 200.0;
      live.test.bend(static_cast<int>(12.0 - 12.0 * std::cos(phase)),
                     begin + tick * std::chrono::milliseconds(11));
      live.test.frame_after_tick(tick);
    }
  }
  MadeTimeline made(const Tolerance& tolerance) {
    REQUIRE(live.end());
    auto timeline = timeline_of_take(live.path, live.test.model, tolerance);
    CAPTURE((timeline ? std::string() : timeline.error().message));
    REQUIRE(timeline);
    return *std::move(timeline);
  }
};

constexpr Tolerance none{0.0, 0.0};

} // namespace

TEST_SUITE("player") {
  TEST_CASE("with every frame a key it makes the take's every shape, in all modes, also where "
            "commits are undone and redone") {
    struct Way {
      Mode mode;
      bool injective;
      flow::SwitchAction action;
    };
    using flow::SwitchAction;
    for (const Way& way :
         {Way{Mode::type1, false, SwitchAction::none}, Way{Mode::type2, false, SwitchAction::none},
          Way{Mode::type1, true, SwitchAction::toggle}, Way{Mode::type2, true, SwitchAction::grab},
          Way{Mode::type1, false, SwitchAction::commit}}) {
      CAPTURE(name_of(way.mode));
      CAPTURE(name_of(way.action));
      Taken taken(way.mode, way.injective, way.action);
      test::play(taken.live, 400);
      const MadeTimeline made = taken.made(none);
      CHECK(made.exact);
      CHECK(made.timeline.events.size() > 5);
      const auto player = playing(made.timeline, taken.live.test.model);
      auto reader = recording::TakeReader::open(taken.live.path);
      REQUIRE(reader);
      auto replay = recording::LoopReplay::make(reader->setup(), taken.live.test.model);
      REQUIRE(replay);
      REQUIRE(player->next()); // where the hands grabbed
      CHECK(player->time_s() == 0.0);
      Points wanted;
      Points shape;
      double worst = 0.0;
      std::uint64_t frames = 0;
      while (const auto entry = reader->next()) {
        if (!(*replay)->feed(*entry)) continue;
        REQUIRE(player->next());
        ++frames;
        (*replay)->loop().frames().update();
        const flow::Frame& frame = (*replay)->loop().frames().front();
        CHECK(player->frame().held == frame.held);
        player->layout().unpack(frame.shape, wanted);
        player->layout().unpack(player->frame().shape, shape);
        worst = std::max(worst, farthest(shape, wanted));
      }
      CHECK(frames == 400);
      CHECK_FALSE(player->next());
      CHECK(worst < test::float_gap);
      const auto& stats = (*replay)->loop().stats();
      CHECK(player->stats().undos == stats.undos);
      CHECK(player->stats().redos == stats.redos);
      CHECK(farthest(player->final_shape(), (*replay)->loop().final_shape()) < test::float_gap);
      CHECK(player->last_time_s() == doctest::Approx(made.timeline.duration_s));
    }
  }

  TEST_CASE("so it does where settings change on the way, and changes are undone and redone") {
    // Brushes have a part in the last ones only: where they crumple a surface, they make much of
    // the last bits of the angles, which poses do not keep.
    for (unsigned seed = 0; static_cast<int>(seed) < test::rounds(24) + 2; ++seed) {
      const bool brushes = static_cast<int>(seed) >= test::rounds(24);
      CAPTURE(seed);
      Taken taken(seed % 2 == 0 ? Mode::type1 : Mode::type2, seed % 4 == 3);
      auto& loop = *taken.live.test.loop;
      std::mt19937 random(seed);
      // Not now: what the last bits of the times make of a shape would differ from run to run.
      const HostTime begin{std::chrono::hours(1)};
      int bent = 0;
      std::vector<Points> shapes;
      for (std::uint64_t tick = 0; tick < 300; ++tick) {
        bent = std::clamp(bent + static_cast<int>(random() % 5) - 2, 0, 30);
        taken.live.test.bend(bent, begin + tick * std::chrono::milliseconds(11));
        flow::LoopSettings settings = test::any_settings(loop.changes().settings(), random);
        settings.filter = loop.changes().settings().filter;
        settings.brushes.fill(brushes ? deform::Brush::inflate : deform::Brush::pull);
        settings.brush_strength = 0.1;
        if (random() % 15 == 0) static_cast<void>(loop.changes().change_settings(settings));
        if (seed % 3 == 1 && tick % 20 == 7) // masks and symmetry, too
          if (const auto masks =
                  test::any_masks(loop.changes().puppet(loop.changes().newest_puppet()), random))
            taken.live.change_puppet(masks);
        if (random() % 10 == 0)
          taken.live.test.commands.try_push(flow::requests[random() % flow::requests.size()]);
        const flow::Frame& frame = taken.live.test.frame_after_tick(tick);
        shapes.push_back(taken.live.test.vertices_of(frame));
        if (frame.awaited) static_cast<void>(loop.changes().change_to(*frame.awaited));
      }
      const std::uint64_t changes = loop.stats().changes;
      CHECK(changes > 5);
      const MadeTimeline made = taken.made(none);
      // Also after it has been a file.
      const auto text = timeline_text(made.timeline);
      REQUIRE(text);
      const auto read = parse_timeline(*text, "test");
      CAPTURE((read ? std::string() : read.error().message));
      REQUIRE(read);
      const auto player = playing(*read, taken.live.test.model);
      REQUIRE(player->next());
      Points shape;
      double worst = 0.0;
      for (const Points& wanted : shapes) {
        REQUIRE(player->next());
        player->layout().unpack(player->frame().shape, shape);
        worst = std::max(worst, farthest(shape, wanted));
      }
      CHECK(worst < 1e-5);
      CHECK(player->stats().changes == changes);
    }
  }

  TEST_CASE(
      "a model that becomes finer is also finer in the timeline, and what was undone is back") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      CAPTURE(name_of(mode));
      Taken taken(mode);
      auto& live = taken.live.test;
      const HostTime begin = HostClock::now();
      std::uint64_t tick = 0;
      const auto next = [&](int bent) {
        live.bend(bent, begin + tick * std::chrono::milliseconds(11));
        const flow::Frame& frame = taken.live.test.frame_after_tick(tick++);
        if (frame.awaited) static_cast<void>(live.loop->changes().change_to(*frame.awaited));
      };
      const auto change_model = [&](const flow::ChangeModel& change, int bent) {
        auto finer = flow::PendingModel::make(live.loop->changes().newest_model(), change);
        REQUIRE(finer);
        REQUIRE(live.loop->changes().hold_still());
        next(bent);
        REQUIRE(live.loop->changes().change_model(*finer));
        next(bent);
      };
      const flow::ChangeModel subdivided{0, flow::ModelSource::subdivided};
      for (int bent = 0; bent < 12; ++bent)
        next(bent);
      change_model(subdivided, 12);
      for (int bent = 12; bent < 24; ++bent)
        next(bent);
      for (const auto request :
           {flow::Request::commit, flow::Request::undo, flow::Request::undo, flow::Request::redo}) {
        live.commands.try_push(request);
        for (int at = 0; at < 3; ++at)
          next(24);
      }
      change_model(subdivided, 24);
      for (int bent = 24; bent > 6; --bent)
        next(bent);
      const deform::Mesh wanted = live.loop->final_mesh();
      const MadeTimeline made = taken.made(none);
      const auto text = timeline_text(made.timeline);
      REQUIRE(text);
      const auto read = parse_timeline(*text, "test");
      REQUIRE(read);
      const auto player = playing(*read, live.model);
      while (player->next()) {
      }
      CHECK(player->stats().redos == 1);
      CHECK(player->frame().model == live.loop->frames().front().model);
      REQUIRE(player->final_shape().cols() == wanted.vertices.cols());
      CHECK(farthest(player->final_shape(), wanted.vertices) <
            (mode == Mode::type1 ? 1e-5 : 0.02)); // the way is cut elsewhere
    }
  }

  TEST_CASE("a model that is refined is also refined in the timeline, up to as many vertices") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      CAPTURE(name_of(mode));
      Taken taken(mode);
      auto& live = taken.live.test;
      const HostTime begin = HostClock::now();
      std::uint64_t tick = 0;
      const auto next = [&](int bent) {
        live.bend(bent, begin + tick * std::chrono::milliseconds(11));
        taken.live.test.frame_after_tick(tick++);
      };
      const auto most = static_cast<std::uint32_t>(live.model.vertices.cols());
      for (int bent = 0; bent < 130; ++bent)
        next(bent);
      auto finer = flow::PendingModel::make(live.loop->changes().newest_model(),
                                            {0, flow::ModelSource::refined, most});
      REQUIRE(finer);
      REQUIRE(live.loop->changes().hold_still());
      next(130);
      auto unbounded =
          flow::PendingModel::make(live.loop->changes().newest_model(),
                                   {0, flow::ModelSource::refined, flow::Refine{}.max_vertices});
      REQUIRE(unbounded);
      CHECK((*unbounded->finish(9, {}))->layout().vertex_count() > most);
      REQUIRE(live.loop->changes().change_model(*finer));
      for (int bent = 130; bent > 120; --bent)
        next(bent);
      const deform::Mesh wanted = live.loop->final_mesh();
      CHECK(wanted.vertices.cols() <= most);
      const MadeTimeline made = taken.made(none);
      const auto text = timeline_text(made.timeline);
      REQUIRE(text);
      CHECK(text->find("refine = " + std::to_string(most)) != std::string::npos);
      const auto read = parse_timeline(*text, "test");
      REQUIRE(read);
      const auto player = playing(*read, live.model);
      while (player->next()) {
      }
      REQUIRE(player->final_shape().cols() == wanted.vertices.cols());
      CHECK(farthest(player->final_shape(), wanted.vertices) < (mode == Mode::type1 ? 1e-5 : 0.02));
    }
  }

  TEST_CASE(
      "a take in which the filter changes, or which begins in the middle of a run, becomes no "
      "timeline") {
    Taken filtered(Mode::type1);
    flow::LoopSettings settings = filtered.live.test.loop->changes().settings();
    settings.filter.kind = hand::FilterKind::one_euro;
    static_cast<void>(filtered.live.test.loop->changes().change_settings(settings));
    filtered.bend(3);
    REQUIRE(filtered.live.end());
    const auto refused = timeline_of_take(filtered.live.path, filtered.live.test.model, none);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == Errc::bad_input);
    CHECK(refused.error().message.find("filter") != std::string::npos);
    Taken part(Mode::type1);
    part.bend(3);
    REQUIRE(part.live.end());
    test::RecordedLoop middle(Mode::type1);
    middle.setup.loop->rest.resize(middle.test.loop->changes().layout().block_count());
    middle.record();
    REQUIRE(middle.end());
    CHECK_FALSE(timeline_of_take(middle.path, middle.test.model, none));
  }

  TEST_CASE("whatever the rate, the frames are all those up to the end, with what is due there") {
    const deform::Mesh model = test::ball(4);
    Taken taken(Mode::type1);
    taken.bend(1);
    const Timeline one = taken.made(none).timeline;
    for (const double rate_hz : {20.0, 30.0, 59.94, 60.0, 90.0, 144.0, 1000.0}) {
      CAPTURE(rate_hz);
      for (unsigned n = 0; n < 50; ++n) {
        CAPTURE(n);
        Timeline timeline = one;
        timeline.rate_hz = rate_hz;
        // As a file has it, which people write: a decimal.
        timeline.duration_s = std::stod(std::to_string(n * 1e9 / rate_hz)) / 1e9;
        timeline.held = true;
        timeline.events = {{timeline.duration_s, flow::Request::commit}};
        const auto player = playing(timeline, model);
        for (unsigned frame = 0; frame <= n; ++frame) {
          REQUIRE(player->has_frame_by(frame / rate_hz));
          if (frame > 0) CHECK_FALSE(player->has_frame_by((frame - 0.1) / rate_hz));
          REQUIRE(player->stats().commits == 0);
          REQUIRE(player->next());
          REQUIRE(player->time_s() == doctest::Approx(frame / rate_hz));
        }
        CHECK(player->stats().commits == 1);
        CHECK_FALSE(player->has_frame_by(1e9));
        CHECK_FALSE(player->next());
      }
    }
  }

  TEST_CASE("more events than a timeline may have are refused, none is left out") {
    Taken taken(Mode::type1);
    for (std::uint64_t tick = 0; tick < 10; ++tick) {
      for (int times = 0; times < 4; ++times)
        taken.live.test.commands.try_push(flow::Request::undo);
      taken.live.test.frame_after_tick(tick);
    }
    const std::size_t events = taken.made(none).timeline.events.size();
    REQUIRE(events == 40);
    const auto make = [&](std::size_t most) {
      return timeline_of_take(taken.live.path, taken.live.test.model, none, most);
    };
    CHECK(make(40));
    const auto refused = make(39);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == Errc::bad_input);
    CHECK(refused.error().message.find("more than 39 events") != std::string::npos);
    CHECK(refused.error().message.find("nendo recording cut") != std::string::npos);
  }

  TEST_CASE("more frames than a timeline may have are refused, none is left out") {
    Taken taken(Mode::type1);
    taken.bend(10);
    REQUIRE(taken.made(none).hands[0].frames == 11); // one a tick, and one before
    const auto refused = timeline_of_take(taken.live.path, taken.live.test.model, none, 10);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("more than 10 frames") != std::string::npos);
    CHECK(timeline_of_take(taken.live.path, taken.live.test.model, none, 11));
  }

  TEST_CASE("with few keys the shape is as near as they are") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      CAPTURE(name_of(mode));
      Taken taken(mode);
      taken.bend(350);
      constexpr double tip_m = 3e-3; // a count of the gloves moves a tip by about a millimetre
      const MadeTimeline made = taken.made({.tip_m = tip_m});
      for (std::size_t hand = 0; hand < 2; ++hand) {
        CHECK(made.hands[hand].worst.tip_m <= tip_m);
        CHECK(made.hands[hand].frames == 351);
        CHECK(made.timeline.hands[hand].keys.size() < 60);
      }
      const auto player = playing(made.timeline, taken.live.test.model);
      while (player->next()) {
      }
      const double off = farthest(player->final_shape(), taken.live.test.loop->final_shape());
      // Fields of fingertips so far apart are hardly larger than what moves them.
      CHECK(off < 4.0 * tip_m * taken.live.test.placement.units_per_metre);
      CHECK(farthest(player->final_shape(), taken.live.test.model.vertices) > 0.02);
    }
  }

  TEST_CASE("a timeline that was written and read makes the same shapes, bit for bit") {
    Taken taken(Mode::type2);
    test::play(taken.live, 100);
    const MadeTimeline made = taken.made({.tip_m = 1e-3});
    const auto text = timeline_text(made.timeline);
    REQUIRE(text);
    const auto back = parse_timeline(*text, "back");
    REQUIRE(back);
    const auto one = playing(made.timeline, taken.live.test.model);
    const auto other = playing(*back, taken.live.test.model);
    while (one->next())
      REQUIRE(other->next());
    CHECK_FALSE(other->next());
    CHECK(one->final_shape() == other->final_shape());
  }

  TEST_CASE("mirrored hands make the mirrored shape of a mirrored model") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      Taken taken(mode);
      taken.bend(120);
      MadeTimeline made = taken.made({.tip_m = 1e-3});
      const deform::Mesh& model = taken.live.test.model;
      deform::Mesh mirrored = model;
      mirrored.vertices.row(0) = -model.vertices.row(0);
      const auto one = playing(made.timeline, model);
      REQUIRE(mirror(made.timeline, 0.0));
      const auto other = playing(made.timeline, mirrored);
      while (one->next())
        REQUIRE(other->next());
      Points shape = other->final_shape();
      shape.row(0) = -shape.row(0).eval();
      CHECK(farthest(shape, one->final_shape()) < 10 * test::float_gap);
    }
  }

  TEST_CASE("what cannot be played is refused, and hostile numbers give finite shapes") {
    Taken taken(Mode::type1);
    taken.bend(20);
    const Timeline fine = taken.made(none).timeline;
    const deform::Mesh& model = taken.live.test.model;
    Timeline bad = fine;
    bad.hands.clear();
    CHECK_FALSE(Player::make(bad, model));
    bad = fine;
    bad.rate_hz = 0.0;
    CHECK_FALSE(Player::make(bad, model));
    bad = fine;
    for (auto& hand : bad.hands)
      for (Key& key : hand.keys) {
        key.wrist_m = Eigen::Vector3d(farthest_m, -farthest_m, 0.0);
        key.wrist_turn = {0.0, 0.0, 0.0, 1.0};
      }
    bad.hands[0].keys.back().wrist_m.setConstant(-farthest_m);
    bad.units_per_metre = 1e90;
    if (const auto player = Player::make(bad, model)) {
      while ((*player)->next()) {
      }
      CHECK((*player)->final_shape().allFinite());
    }
    test::write_bytes(taken.live.folder.path() / "no.nendo", "nothing");
    CHECK_FALSE(timeline_of_take(taken.live.folder.path() / "no.nendo", model, none));
  }
}

} // namespace player_test
