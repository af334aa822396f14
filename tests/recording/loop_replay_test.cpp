#include <nendo/recording/loop_replay.hpp>

#include <atomic>
#include <memory>
#include <random>
#include <thread>

#include <doctest/doctest.h>

#include "support/pinching_sample.hpp"
#include "support/takes.hpp"

namespace loop_replay_test {

using namespace nendo;
using namespace nendo::recording;
using flow::Mode;
using hand::FilterKind;
using test::RecordedLoop;

namespace {

/// Feeds all of a recording. REQUIREs that it can be replayed.
std::unique_ptr<LoopReplay> replayed(const std::filesystem::path& path, const deform::Mesh& model) {
  auto reader = TakeReader::open(path);
  REQUIRE(reader);
  auto replay = LoopReplay::make(reader->setup(), model);
  REQUIRE(replay);
  while (const auto entry = reader->next())
    (*replay)->feed(*entry);
  return *std::move(replay);
}

} // namespace

TEST_SUITE("loop_replay") {
  TEST_CASE("a replay without a clock has the live loop's shape, bit for bit, and its statistics") {
    struct Way {
      Mode mode;
      FilterKind filter;
      bool adapts, injective;
      flow::SwitchAction action;
    };
    using flow::SwitchAction;
    for (const Way& way : {Way{Mode::type1, FilterKind::off, false, false, SwitchAction::none},
                           Way{Mode::type2, FilterKind::off, false, false, SwitchAction::none},
                           Way{Mode::type1, FilterKind::one_euro, true, true, SwitchAction::toggle},
                           Way{Mode::type2, FilterKind::one_euro, true, true, SwitchAction::commit},
                           Way{Mode::type1, FilterKind::off, false, true, SwitchAction::grab}}) {
      CAPTURE(name_of(way.mode));
      CAPTURE(way.injective);
      RecordedLoop live(way.mode, way.filter, way.adapts, way.injective, way.action);
      live.record();
      test::play(live, 600);
      const auto recorded = live.end();
      REQUIRE(recorded);
      CHECK(recorded->lost == 0);
      const auto replay = replayed(live.path, live.test.model);
      CHECK(replay->is_exact());
      const deform::Points shape = replay->loop().final_shape();
      CHECK(shape == live.test.loop->final_shape());
      CHECK((shape - live.test.model.vertices).cwiseAbs().maxCoeff() > 1e-3);
      const auto& stats = replay->loop().stats();
      const auto& wanted = live.test.loop->stats();
      CHECK(stats.ticks == wanted.ticks);
      CHECK(stats.samples == wanted.samples);
      CHECK(stats.switch_uses == wanted.switch_uses);
      CHECK(stats.grabs == wanted.grabs);
      CHECK(stats.commits == wanted.commits);
      CHECK(stats.undos == wanted.undos);
      CHECK(stats.redos == wanted.redos);
      CHECK(stats.silences == wanted.silences);
      CHECK(wanted.commits + wanted.undos > 0);
    }
  }

  TEST_CASE("a whole hand, and clay, are replayed bit for bit") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      for (const double keep_volume : {0.0, 0.6}) {
        if (mode == Mode::type2 && keep_volume == 0.0) continue; // as above
        CAPTURE(name_of(mode));
        CAPTURE(keep_volume);
        RecordedLoop live(mode);
        auto& test = live.test;
        test.options.sculptor.hold = flow::Hold::hand;
        test.options.sculptor.deformer.csrbf.keep_volume = keep_volume;
        test.loop = std::make_unique<flow::DeformLoop>(test.model, test.placement, test.inputs,
                                                       test.options);
        live.setup = test::setup_of(test);
        live.record();
        test::play(live, 300);
        const auto recorded = live.end();
        REQUIRE(recorded);
        const auto replay = replayed(live.path, test.model);
        CHECK(replay->is_exact());
        CHECK(replay->loop().final_shape() == test.loop->final_shape());
        CHECK((test.loop->final_shape() - test.model.vertices).cwiseAbs().maxCoeff() > 1e-3);
      }
    }
  }

  TEST_CASE("hands that carry parts are replayed bit for bit") {
    RecordedLoop live(Mode::parts);
    auto& test = live.test;
    const Eigen::Vector3d top(0.0, 1.0 / test.placement.units_per_metre, 0.0);
    const Eigen::Isometry3d at_top = test::wrist_pinching_at(Side::right, top);
    test.placement.T_stage_wrist[1] = at_top;
    test.loop =
        std::make_unique<flow::DeformLoop>(test.model, test.placement, test.inputs, test.options);
    live.setup = test::setup_of(test);
    live.record();
    std::mt19937 random(1);
    HostTime now = HostClock::now();
    std::uint64_t held = 0;
    for (std::uint64_t tick = 0; tick < 600; ++tick) {
      now += std::chrono::milliseconds(11);
      const bool closes = tick / 40 % 2 == 1;
      test.rings[0]->try_push(test::bent_sample(Side::left, 0, now));
      test.rings[1]->try_push(closes ? test::pinching_sample(Side::right, now)
                                     : test::bent_sample(Side::right, 0, now));
      Eigen::Isometry3d wrist = at_top;
      if (closes) {
        const auto part = static_cast<double>(tick % 40);
        wrist.translation().x() += 1e-3 * part;
        wrist.rotate(Eigen::AngleAxisd(0.01 * part, Eigen::Vector3d::UnitY()));
      }
      test.commands.try_push(flow::WristMove::to(Side::right, wrist));
      if (random() % 40 == 0)
        test.commands.try_push(flow::requests[random() % flow::requests.size()]);
      held += test.frame_after_tick(tick).parts.is_held() ? 1U : 0U;
    }
    CHECK(held > 100);
    REQUIRE(live.end());
    const auto replay = replayed(live.path, test.model);
    CHECK(replay->is_exact());
    CHECK(replay->loop().final_shape() == test.loop->final_shape());
    CHECK((test.loop->final_shape() - test.model.vertices).cwiseAbs().maxCoeff() > 1e-3);
  }

  TEST_CASE(
      "a loop that continues with the learned ranges of a previous one is replayed with them") {
    bool slips = false;
    SUBCASE("ranges") {}
    SUBCASE("slips") {
      slips = true;
    }
    RecordedLoop before(Mode::type1, FilterKind::off, true, false, flow::SwitchAction::none,
                        nullptr, slips);
    test::play(before, 600);
    RecordedLoop live(Mode::type1, FilterKind::off, true, false, flow::SwitchAction::none, nullptr,
                      slips);
    auto& test = live.test;
    before.test.loop->changes().change_log(nullptr, before.test.loop->frames().front().shape);
    before.test.frame_after_tick(600);
    const auto state = before.test.loop->changes().take_state();
    REQUIRE(state);
    for (std::size_t at = 0; at < test.inputs.size(); ++at)
      test.inputs[at].wearer.learned = state->inputs[at].learned;
    test.loop =
        std::make_unique<flow::DeformLoop>(test.model, test.placement, test.inputs, test.options);
    live.setup = test::setup_of(test);
    live.record();
    test::play(live, 600);
    REQUIRE(live.end());
    const auto replay = replayed(live.path, test.model);
    CHECK(replay->is_exact());
    CHECK(replay->loop().final_shape() == test.loop->final_shape());
    const auto turns = [](const flow::DeformLoop& loop) {
      std::uint64_t sum = 0;
      for (const auto& sensor : loop.stats().ranges[0])
        sum += sensor.turns;
      return sum;
    };
    CHECK(replay->loop().stats().slips_counts == test.loop->stats().slips_counts);
    CHECK(turns(*before.test.loop) > 0);
    CHECK(turns(replay->loop()) == turns(*test.loop));
    CHECK(turns(*test.loop) > turns(*before.test.loop));
  }

  TEST_CASE("every frame on the way is the live one's") {
    RecordedLoop live(Mode::type2, FilterKind::off, false, true);
    live.record();
    std::vector<deform::Points> shapes;
    const HostTime begin = HostClock::now();
    for (std::uint64_t tick = 0; tick < 60; ++tick) {
      live.test.bend(static_cast<int>(tick % 25), begin + tick * std::chrono::milliseconds(11));
      if (tick == 30) live.test.commands.try_push(flow::Request::commit);
      shapes.push_back(live.test.vertices_of(live.test.frame_after_tick(tick)));
    }
    REQUIRE(live.end());
    auto reader = TakeReader::open(live.path);
    REQUIRE(reader);
    auto replay = LoopReplay::make(reader->setup(), live.test.model);
    REQUIRE(replay);
    std::size_t at = 0;
    while (const auto entry = reader->next()) {
      if (!(*replay)->feed(*entry)) continue;
      (*replay)->loop().frames().update();
      CHECK(live.test.vertices_of((*replay)->loop().frames().front()) == shapes[at++]);
    }
    CHECK(at == shapes.size());
  }

  TEST_CASE("undos and redos, far beyond the memory that a loop begins with, are replayed bit for "
            "bit") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      RecordedLoop live(mode);
      live.test.options.undo_max_bytes = std::size_t{1} << 30;
      live.test.options.sculptor.deformer.undo_bytes = 100'000;
      live.test.loop = std::make_unique<flow::DeformLoop>(live.test.model, live.test.placement,
                                                          live.test.inputs, live.test.options);
      live.setup = test::setup_of(live.test);
      live.record();
      std::uint64_t tick = 0;
      const HostTime begin = HostClock::now();
      const auto ask = [&](flow::Request request) {
        live.test.loop->changes().refill_undo();
        live.test.commands.try_push(request);
        live.test.bend(static_cast<int>(7 * tick % 25),
                       begin + tick * std::chrono::milliseconds(11));
        live.test.frame_after_tick(tick++);
      };
      for (int at = 0; at < 60; ++at)
        ask(flow::Request::commit);
      ask(flow::Request::release);
      for (int at = 0; at < 55; ++at)
        ask(flow::Request::undo);
      for (int at = 0; at < 30; ++at)
        ask(flow::Request::redo);
      REQUIRE(live.end());
      const auto replay = replayed(live.path, live.test.model);
      CHECK(replay->is_exact());
      CHECK(replay->loop().stats().redos == 30);
      CHECK(replay->loop().stats().undo_steps == live.test.loop->stats().undo_steps);
      const deform::Points shape = replay->loop().final_shape();
      CHECK(shape == live.test.loop->final_shape());
      CHECK(shape != live.test.model.vertices);
    }
  }

  TEST_CASE("undos while the hands pull are replayed") {
    RecordedLoop live(Mode::type1);
    live.record();
    const HostTime begin = HostClock::now();
    for (std::uint64_t tick = 0; tick < 60; ++tick) {
      if (tick == 15 || tick == 30) live.test.commands.try_push(flow::Request::commit);
      if (tick == 45) live.test.commands.try_push(flow::Request::undo);
      live.test.bend(static_cast<int>(tick % 40), begin + tick * std::chrono::milliseconds(11));
      live.test.frame_after_tick(tick);
    }
    REQUIRE(live.end());
    const auto replay = replayed(live.path, live.test.model);
    CHECK(replay->is_exact());
    CHECK(replay->loop().stats().undo_steps == 2);
    CHECK(replay->loop().final_shape() == live.test.loop->final_shape());
  }

  TEST_CASE("the loop at its own rate, on its own thread, is replayed as well") {
    RecordedLoop live(Mode::type1);
    live.record();
    std::atomic<bool> stop{false};
    std::thread runs([&] { live.test.loop->run(stop, 300); });
    const HostTime begin = HostClock::now();
    for (int at = 0; at < 100; ++at) {
      live.test.bend(at % 25, begin + at * std::chrono::milliseconds(3));
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    runs.join();
    REQUIRE(live.end());
    const auto replay = replayed(live.path, live.test.model);
    CHECK(replay->is_exact());
    CHECK(replay->loop().final_shape() == live.test.loop->final_shape());
  }

  TEST_CASE("what found the input log full is counted, and the replay says that it is not exact") {
    RecordedLoop live(Mode::type1);
    const HostTime begin = HostClock::now();
    // The input log is not emptied: 3 entries per tick, and 2^14 of them fit.
    constexpr std::uint64_t ticks = 6000;
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      live.test.bend(static_cast<int>(tick % 20), begin + tick * std::chrono::milliseconds(11));
      live.test.frame_after_tick(tick);
    }
    live.record();
    live.test.frame_after_tick(ticks); // the recorder may have emptied the log by then, or not
    const auto recorded = live.end();
    REQUIRE(recorded);
    CHECK(recorded->lost > 0);
    CHECK(recorded->lost + recorded->samples + recorded->ticks == 3 * ticks + 1);
    CHECK(live.warnings.size() == 1);
    CHECK_FALSE(replayed(live.path, live.test.model)->is_exact());
  }

  TEST_CASE("gloves alone, and hands that are not there, are no loop") {
    RecordedLoop live(Mode::type1);
    Setup setup = live.setup;
    CHECK(LoopReplay::make(setup, live.test.model));
    setup.loop->options.sculptor.deformer.supports.own.push_back({10, {1.0, 1.0}});
    CHECK_FALSE(LoopReplay::make(setup, live.test.model));
    setup = live.setup;
    setup.loop.reset();
    CHECK_FALSE(LoopReplay::make(setup, live.test.model));
    setup = live.setup;
    setup.hands.clear();
    CHECK_FALSE(LoopReplay::make(setup, live.test.model));
  }
}

} // namespace loop_replay_test
