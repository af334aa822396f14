#include <nendo/flow/deform_loop.hpp>

#include <cstdlib>
#include <random>
#include <thread>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"

namespace deform_loop_test {

using namespace nendo;
using namespace nendo::flow;
using nendo::test::LoopUnderTest;
using namespace std::chrono_literals;

TEST_SUITE("deform_loop") {
  TEST_CASE("hands that do not move leave the model as it is") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      LoopUnderTest test(mode);
      for (std::uint64_t tick = 0; tick < 5; ++tick) {
        test.bend(0, HostClock::now());
        CHECK(test.vertices_of(test.frame_after_tick(tick)) == test.model.vertices);
      }
      CHECK(test.loop->final_shape() == test.model.vertices);
    }
  }

  TEST_CASE("bending the fingers presses them into the model, and both hands do it alike") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      LoopUnderTest test(mode);
      for (int turn = 1; turn <= 20; ++turn) {
        test.bend(turn, HostClock::now());
        test.frame_after_tick(static_cast<std::uint64_t>(turn));
      }
      const deform::Points shape = test.loop->final_shape();
      CHECK(shape.allFinite());
      CHECK((shape - test.model.vertices).cwiseAbs().maxCoeff() > 0.05);
      CHECK(shape.colwise().norm().minCoeff() < 0.95); // the ball's radius was 1
      CHECK(shape.row(0).maxCoeff() == doctest::Approx(-shape.row(0).minCoeff()).epsilon(0.02));
    }
  }

  TEST_CASE("a frame's fields are enough to deform a copy of the model elsewhere") {
    LoopUnderTest test(Mode::type1);
    test.bend(15, HostClock::now());
    const Frame& frame = test.frame_after_tick(0);
    deform::Points copy;
    REQUIRE(frame.fields.fields().size() == 1);
    deform::displace(frame.fields.fields().front(), test.model.vertices, copy);
    CHECK((copy - test.vertices_of(frame)).cwiseAbs().maxCoeff() < test::float_gap);
    CHECK(frame.fields.fields().front().centres.cols() == 10);
  }

  TEST_CASE("a frame shows both hands, touching the model where they grabbed it") {
    LoopUnderTest test(Mode::type1);
    const Frame& frame = test.frame_after_tick(0);
    for (const auto& hand : frame.hands) {
      REQUIRE(hand.present);
      const auto tips = (frame.units_per_metre * hand.pose.fingertip_positions()).eval();
      for (Eigen::Index i = 0; i < 5; ++i)
        CHECK(tips.col(i).norm() == doctest::Approx(1.0).epsilon(0.05));
    }
  }

  TEST_CASE("a glove that falls silent freezes its hand, is reported, and comes back by itself") {
    LoopUnderTest test(Mode::type1);
    const HostTime now = HostClock::now();
    test.rings[0]->try_push(test::bent_sample(Side::left, 10, now - 2s));
    test.rings[1]->try_push(test::bent_sample(Side::right, 10, now));
    const deform::Points shape = test.vertices_of(test.frame_after_tick(0));
    CHECK(test.loop->frames().front().hands[0].silent);
    CHECK_FALSE(test.loop->frames().front().hands[1].silent);
    CHECK(test.vertices_of(test.frame_after_tick(1)) == shape);
    CHECK(test.loop->stats().silences[0] == 1);
    test.rings[0]->try_push(test::bent_sample(Side::left, 20, HostClock::now()));
    const Frame& back = test.frame_after_tick(2);
    CHECK_FALSE(back.hands[0].silent);
    CHECK(test.vertices_of(back) != shape);
    CHECK(test.loop->stats().silences[0] == 1);
  }

  TEST_CASE("a damaged count in one sample does not reach the shape, and is reported") {
    for (const bool gated : {true, false}) {
      LoopUnderTest test(Mode::type1, {.gated = gated});
      const HostTime now = HostClock::now();
      test.bend(10, now);
      const deform::Points shape = test.vertices_of(test.frame_after_tick(0));
      GloveSample damaged = test::bent_sample(Side::right, 10, now + 11ms);
      damaged.raw[static_cast<std::size_t>(Sensor::index_mcp)].value ^= 128U;
      test.rings[1]->try_push(damaged);
      CHECK((test.vertices_of(test.frame_after_tick(1)) == shape) == gated);
      test.bend(10, now + 22ms);
      CHECK(test.vertices_of(test.frame_after_tick(2)) == shape);
      const auto& spikes = test.loop->stats().spikes[1];
      CHECK(spikes[static_cast<std::size_t>(Sensor::index_mcp)] == (gated ? 1 : 0));
    }
  }

  TEST_CASE("with the filter on the hands come late, by what is reported, and get there") {
    LoopUnderTest plain(Mode::type1);
    LoopUnderTest filtered(Mode::type1, {.filter = hand::FilterKind::one_euro});
    const auto index_tip = [](const Frame& frame) {
      return frame.hands[1].pose[hand::Joint::index_tip].translation().eval();
    };
    const HostTime start = HostClock::now();
    const auto hold_at = [&](int counts, int first, int last) {
      for (int n = first; n < last; ++n) {
        plain.bend(counts, start + n * 11ms);
        filtered.bend(counts, start + n * 11ms);
        plain.frame_after_tick(static_cast<std::uint64_t>(n));
        filtered.frame_after_tick(static_cast<std::uint64_t>(n));
      }
    };
    hold_at(0, 1, 10);
    const Eigen::Vector3d before = index_tip(plain.loop->frames().front());
    CHECK(index_tip(filtered.loop->frames().front()) == before);
    hold_at(10, 10, 12);
    const Eigen::Vector3d there = index_tip(plain.loop->frames().front());
    const double way = (there - before).norm();
    const double gone = (index_tip(filtered.loop->frames().front()) - before).norm();
    CHECK(gone > 0.05 * way);
    CHECK(gone < 0.9 * way);
    hold_at(10, 12, 400);
    CHECK((index_tip(filtered.loop->frames().front()) - there).norm() < 0.001 * way);
    CHECK((filtered.loop->final_shape() - plain.loop->final_shape()).cwiseAbs().maxCoeff() < 1e-3);
    const LoopStats& stats = filtered.loop->stats();
    CHECK(stats.filter_moving.count() == 2 * 399);
    CHECK(to_seconds(stats.filter_worst.max()) ==
          doctest::Approx(1.0 / (6.283185307179586 * hand::FilterOptions{}.min_cutoff_hz)));
    CHECK(stats.filter_moving.min() < stats.filter_worst.max()); // less in motion
    CHECK(plain.loop->stats().filter_moving.count() == 0);
  }

  TEST_CASE("a rate does not count what had waited before the first tick") {
    LoopUnderTest test(Mode::type1);
    const HostTime begin = HostClock::now() - 10s;
    // 40 samples in the ring, the last 25 of them read from the port in one go, as where another
    // glove took long to open; then 100 per second for 3 s, of which the left one loses every
    // second.
    for (int n = 0; n < 40; ++n)
      test.bend(0, n < 15 ? begin + n * 10ms : begin + 150ms);
    test.frame_after_tick(0);
    CHECK(test.loop->stats().samples[0] == 40);
    CHECK(test.loop->stats().rates[0].per_s() == 0.0); // not known yet
    for (int n = 1; n <= 300; ++n) {
      const HostTime arrival = begin + 150ms + n * 10ms;
      if (n % 2 == 0) test.rings[0]->try_push(test::bent_sample(Side::left, 0, arrival));
      test.rings[1]->try_push(test::bent_sample(Side::right, 0, arrival));
      if (n % 5 == 0) test.frame_after_tick(static_cast<std::uint64_t>(n));
    }
    const LoopStats& stats = test.loop->stats();
    CHECK(stats.samples[0] == 40 + 150);
    CHECK(stats.samples[1] == 40 + 300);
    CHECK(stats.rates[0].per_s() == doctest::Approx(50.0));
    CHECK(stats.rates[1].per_s() == doctest::Approx(100.0));
    test.frame_after_tick(1000); // silence is no slower glove
    CHECK(stats.rates[1].per_s() == doctest::Approx(100.0));
  }

  TEST_CASE("every sample is counted, and only the newest of a tick is shown") {
    LoopUnderTest test(Mode::type1);
    const HostTime now = HostClock::now();
    for (int n = 0; n < 7; ++n)
      test.bend(n, now);
    const deform::Points shape = test.vertices_of(test.frame_after_tick(0));
    CHECK(test.loop->stats().samples[0] == 7);
    CHECK(test.loop->stats().samples[1] == 7);
    CHECK(test.loop->stats().end_to_end.count() == 2);
    LoopUnderTest other(Mode::type1);
    other.bend(6, now);
    CHECK((other.vertices_of(other.frame_after_tick(0)) - shape).cwiseAbs().maxCoeff() < 1e-12);
  }

  TEST_CASE("the loop keeps its grid: every deadline is either a tick or counted as missed") {
    // 10 kHz on a mesh of 320,000 vertices cannot be kept while hands move far, in several links:
    // ticks overrun, deadlines are skipped and not caught up.
    LoopUnderTest test(
        Mode::type1,
        {.rings_of_ball = 400, .rate_hz = 10'000.0, .injective = deform::InjectiveOptions{}});
    std::atomic<bool> stop{false};
    constexpr std::uint64_t deadlines = 2000;
    std::thread glove([&] {
      for (int n = 0; n < 20; ++n) {
        test.bend(n % 2 == 0 ? 80 : 0, HostClock::now());
        std::this_thread::sleep_for(5ms);
      }
    });
    test.loop->run(stop, deadlines);
    glove.join();
    const LoopStats& stats = test.loop->stats();
    CHECK(stats.ticks + stats.missed == deadlines);
    CHECK(stats.overruns > 0);
    CHECK(stats.missed >= stats.overruns);
    CHECK(stats.wake_latency.count() == stats.ticks);
  }

  TEST_CASE("stop ends the loop within a period, while another thread reads its frames") {
    LoopUnderTest test(Mode::type1, {.rate_hz = 200.0});
    std::atomic<bool> stop{false};
    std::thread loop([&] { test.loop->run(stop); });
    std::uint64_t last = 0;
    int seen = 0;
    const HostTime end = HostClock::now() + 20s;
    while (seen < 20 && HostClock::now() < end) {
      test.bend(seen % 10, HostClock::now());
      if (test.loop->frames().update()) {
        const Frame& frame = test.loop->frames().front();
        CHECK(frame.ticks_run > last);
        CHECK(test.vertices_of(frame).allFinite());
        last = frame.ticks_run;
        ++seen;
      }
      std::this_thread::sleep_for(1ms);
    }
    CHECK(seen == 20);
    stop = true;
    const HostTime asked = HostClock::now();
    loop.join();
    CHECK(HostClock::now() - asked < 2s); // a period is 5 ms; the rest is for a loaded machine
  }

  TEST_CASE("every frame is shown to every sink, also those that no reader took") {
    struct Sink final : flow::FrameSink {
      void show(const Frame& frame) noexcept override {
        if (frame.ticks_run != seen + 1) in_order = false;
        seen = frame.ticks_run;
        tips = frame.hands[0].pose.fingertip_positions();
      }
      std::uint64_t seen = 0;
      bool in_order = true;
      flow::Fingertips tips = flow::Fingertips::Zero();
    };
    std::array<Sink, 2> sinks;
    LoopUnderTest test(Mode::type1);
    test.options.sinks = {&sinks[0], &sinks[1]};
    flow::DeformLoop loop(test.model, test.placement, test.inputs, test.options);
    for (std::uint64_t tick = 0; tick < 5; ++tick) {
      test.bend(static_cast<int>(tick), HostClock::now());
      loop.tick(tick, HostClock::now());
    }
    REQUIRE(loop.frames().update());
    for (const Sink& sink : sinks) {
      CHECK(sink.seen == 5);
      CHECK(sink.in_order);
      CHECK((sink.tips.array() == loop.frames().front().hands[0].pose.fingertip_positions().array())
                .all());
    }
  }

  TEST_CASE("after a swap a jump is judged by the gains of the glove that is there") {
    // 40 counts in 11 ms are no movement at 0.0125 rad each, and one at a tenth of that.
    for (const bool slow_first : {true, false}) {
      const HostTime now = HostClock::now();
      SampleRing ring(64);
      const hand::Calibration fast = hand::default_calibration();
      hand::Calibration slow = fast;
      for (auto& sensor : slow.sensors)
        sensor.gain_rad_per_count *= 0.1;
      const GloveSample first = nendo::test::bent_sample(Side::right, 0, now);
      HandInput input{&ring, Side::right, {}, first};
      input.wearer.right.calibration = slow_first ? slow : fast;
      input.wearer.left.calibration = slow_first ? fast : slow;
      flow::LoopOptions options;
      options.sculptor.deformer.supports = deform::one_radius(0.5);
      flow::DeformLoop loop(nendo::test::ball(12), {}, {input}, options);
      int sample = 0;
      for (const auto& [side, counts] : {std::pair{Side::right, 40},
                                         {Side::right, 0},
                                         {Side::left, 0},
                                         {Side::left, 40},
                                         {Side::left, 0}}) {
        ring.try_push(nendo::test::bent_sample(side, counts, now + ++sample * 11ms));
        loop.tick(static_cast<std::uint64_t>(sample), HostClock::now());
        const auto spikes = loop.stats().spikes[1][static_cast<std::size_t>(Sensor::index_mcp)];
        // Kept out, and counted when it has come back.
        const std::uint64_t of_first = !slow_first && sample >= 2 ? 1 : 0;
        const std::uint64_t of_swapped = slow_first && sample >= 5 ? 1 : 0;
        CHECK(spikes == of_first + of_swapped);
      }
    }
  }

  TEST_CASE("a loop that adapts learns each hand's ranges as hand::RangeAdaptation does") {
    const HostTime now = HostClock::now();
    LoopUnderTest test(Mode::type1, {.adapt = CountScale{}});
    LoopUnderTest plain(Mode::type1);
    hand::RangeAdaptation reference;
    reference.push(test::bent_sample(Side::right, 0, now));
    for (int n = 0; n <= 1000; ++n) {         // and there they are at the least
      const int bent = std::abs(n % 80 - 40); // 40 counts to and fro, 0.9 s
      test.bend(bent, now + n * 11ms);
      plain.bend(bent, now + n * 11ms);
      reference.push(test::bent_sample(Side::right, bent, now + n * 11ms));
      test.frame_after_tick(static_cast<std::uint64_t>(n));
      plain.frame_after_tick(static_cast<std::uint64_t>(n));
    }
    constexpr auto index_mcp = static_cast<std::size_t>(Sensor::index_mcp);
    for (const std::size_t slot : {0U, 1U}) {
      const hand::SensorRange& learned = test.loop->stats().ranges[slot][index_mcp];
      const hand::SensorRange known = reference.ranges()[index_mcp];
      CHECK(learned.turns > 10);
      CHECK(learned.turns == known.turns);
      CHECK(learned.low_counts == doctest::Approx(known.low_counts));
      CHECK(learned.high_counts == doctest::Approx(known.high_counts));
      CHECK(plain.loop->stats().ranges[slot][index_mcp].turns == 0);
    }
    const hand::HandSkeleton skeleton(Side::right);
    const GloveSample last = test::bent_sample(Side::right, 0, now);
    const auto tips_by = [&](const hand::Calibration& calibration) {
      return skeleton.pose(hand::joint_angles(last, calibration), test.placement.T_stage_wrist[1])
          .fingertip_positions();
    };
    const auto shown = test.loop->frames().front().hands[1].pose.fingertip_positions();
    CHECK((shown - tips_by(reference.calibration())).cwiseAbs().maxCoeff() < 1e-4);
    CHECK((shown - tips_by(hand::default_calibration())).cwiseAbs().maxCoeff() > 1e-3);
  }

  TEST_CASE("a glove of the other side in the place of the first has its own wearer's size") {
    const HostTime now = HostClock::now();
    SampleRing ring(64);
    HandInput input{&ring, Side::right, {}, nendo::test::bent_sample(Side::right, 0, now)};
    const hand::HandSkeleton usual(Side::right);
    const hand::HandSkeleton small(Side::right, {0.160, 0.070});
    flow::LoopOptions options;
    options.sculptor.deformer.supports = deform::one_radius(0.5);
    for (const bool known : {true, false}) {
      input.wearer.left.size = known ? hand::HandSize{0.160, 0.070} : hand::HandSize{};
      flow::DeformLoop loop(nendo::test::ball(12), {}, {input}, options);
      std::uint64_t number = 0;
      for (const Side side : {Side::right, Side::left, Side::right}) {
        ring.try_push(nendo::test::bent_sample(side, 0, now + (number + 1) * 11ms));
        loop.tick(number++, HostClock::now());
        loop.frames().update();
        // The middle finger's last bone is as long as its wearer's, however it is bent.
        const auto& pose = loop.frames().front().hands[1].pose;
        const double shown = (pose[hand::Joint::middle_tip].translation() -
                              pose[hand::Joint::middle_distal].translation())
                                 .norm();
        const auto& wearer = side == Side::left && known ? small : usual;
        CHECK(shown == doctest::Approx(wearer.rest_offset(hand::Joint::middle_tip).norm()));
      }
    }
    CHECK(small.rest_offset(hand::Joint::middle_tip).norm() <
          0.95 * usual.rest_offset(hand::Joint::middle_tip).norm());
  }

  TEST_CASE("a glove of the other side in the place of the first does not get its calibration") {
    const HostTime now = HostClock::now();
    SampleRing ring(64);
    const GloveSample first = nendo::test::bent_sample(Side::right, 0, now);
    const hand::HandSkeleton skeleton(Side::right);
    hand::Calibration own = hand::default_calibration();
    for (auto& sensor : own.sensors)
      sensor.gain_rad_per_count *= 0.5;
    hand::Calibration swapped = hand::default_calibration();
    for (auto& sensor : swapped.sensors)
      sensor.gain_rad_per_count *= 0.8;
    const auto model = nendo::test::ball(12);
    std::array<std::optional<flow::Fingertips>, 2> tips;
    tips[flow::Placement::index_of(Side::right)] =
        skeleton.pose(hand::joint_angles(first, own), Eigen::Isometry3d::Identity())
            .fingertip_positions();
    const auto placement = flow::place_hands(model, tips);
    flow::LoopOptions options;
    options.sculptor.deformer.supports = deform::one_radius(0.5);
    flow::DeformLoop loop(model, placement,
                          {{&ring, Side::right, {{swapped}, {own}}, first, false}}, options);
    std::uint64_t number = 0;
    for (const Side side : {Side::left, Side::right}) {
      GloveSample sample = nendo::test::bent_sample(side, 30, now);
      ring.try_push(sample);
      loop.tick(number++, HostClock::now());
      loop.frames().update();
      const auto expected =
          skeleton.pose(hand::joint_angles(sample, side == Side::right ? own : swapped),
                        placement.T_stage_wrist[flow::Placement::index_of(Side::right)]);
      const auto& shown = loop.frames().front().hands[flow::Placement::index_of(Side::right)].pose;
      CHECK(shown.fingertip_positions().isApprox(expected.fingertip_positions(), 1e-12));
    }
  }

  TEST_CASE("without a model hands move, whatever is asked") {
    LoopUnderTest test(Mode::type1);
    test.loop = std::make_unique<flow::DeformLoop>(deform::Mesh(), flow::place_without_model(),
                                                   test.inputs, test.options);
    REQUIRE(is_solved(test.loop->grab_status()));
    std::mt19937 random(9);
    Eigen::Vector3d before = Eigen::Vector3d::Zero();
    for (std::uint64_t tick = 0; tick < 300; ++tick) {
      test.bend(std::abs(30 - static_cast<int>(tick % 60)), HostClock::now());
      test.commands.try_push(flow::requests[random() % flow::requests.size()]);
      const flow::Frame& frame = test.frame_after_tick(tick);
      CHECK(frame.shape.block_count() == 0);
      REQUIRE(frame.hands[0].present);
      const Eigen::Vector3d tip = frame.hands[1].pose[hand::Joint::index_tip].translation();
      CHECK(tip.allFinite());
      CHECK(tip != before);
      CHECK(frame.hands[1].T_stage_wrist.translation().x() >
            frame.hands[0].T_stage_wrist.translation().x() + 0.2);
      before = tip;
    }
    CHECK(test.loop->stats().failed == 0);
  }
}

} // namespace deform_loop_test
