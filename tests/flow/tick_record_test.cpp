#include <nendo/flow/pacer.hpp>

#include <thread>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"

namespace tick_record_test {

using namespace nendo;
using namespace nendo::flow;
using namespace std::chrono_literals;

namespace {

/// One hand before a ball.
struct OneHand {
  EventCount event_count;
  SampleRing ring{64, &event_count};
  GloveSample first = test::bent_sample(Side::right, 0, HostClock::now());
  LoopOptions options;
  deform::Mesh model = test::ball(12);

  OneHand() {
    options.rate_hz = 1000.0;
    options.sculptor.deformer.supports = deform::one_radius(0.5);
    options.event_count = &event_count;
  }
  DeformLoop loop() {
    const hand::HandSkeleton skeleton(Side::right);
    std::array<std::optional<Fingertips>, 2> tips;
    tips[Placement::index_of(Side::right)] =
        skeleton
            .pose(hand::joint_angles(first, hand::default_calibration()),
                  Eigen::Isometry3d::Identity())
            .fingertip_positions();
    return DeformLoop(model, place_hands(model, tips), {{&ring, Side::right, {}, first}}, options);
  }
};

} // namespace

TEST_SUITE("tick_record") {
  TEST_CASE("every tick leaves a record, whose stages end one after another") {
    OneHand hand;
    TickRing records(1024);
    hand.options.records = &records;
    DeformLoop loop = hand.loop();
    std::atomic<bool> stop{false};
    hand.ring.try_push(test::bent_sample(Side::right, 5, HostClock::now()));
    loop.run(stop, 100);
    std::uint64_t next = 0;
    std::uint64_t samples = 0;
    std::size_t count = 0;
    records.drain([&](const TickRecord& record) noexcept {
      ++count;
      CHECK(record.tick == next + record.missed);
      next = record.tick + 1;
      CHECK(record.woke >= record.scheduled);
      CHECK(record.drained_ns <= record.posed_ns);
      CHECK(record.posed_ns <= record.solved_ns);
      CHECK(record.solved_ns <= record.published_ns);
      CHECK((record.input != HostTime{}) == (record.samples > 0));
      samples += record.samples;
    });
    CHECK(count == loop.stats().ticks);
    CHECK(samples == 1);
  }

  TEST_CASE("a ring that is not emptied refuses records, and the loop continues") {
    OneHand hand;
    TickRing records(2);
    hand.options.records = &records;
    DeformLoop loop = hand.loop();
    std::atomic<bool> stop{false};
    loop.run(stop, 20);
    CHECK(loop.stats().ticks + loop.stats().missed == 20);
    CHECK(records.counters().refused == loop.stats().ticks - records.capacity());
  }

  TEST_CASE("a frame has the real time since the previous tick, and the missing deadlines") {
    OneHand hand;
    DeformLoop loop = hand.loop();
    HostTime before{};
    for (const std::uint64_t tick : {0U, 1U, 4U}) {
      loop.tick(tick, HostClock::now());
      loop.frames().update();
      const Frame& frame = loop.frames().front();
      CHECK(frame.tick == tick);
      CHECK(frame.since_last ==
            (before == HostTime{} ? HostClock::duration::zero() : frame.woke - before));
      before = frame.woke;
    }
  }

  TEST_CASE("stages that are left out leave their part of the frame as it was") {
    for (const char* left_out : {"input", "hands", "deform"}) {
      OneHand hand;
      auto& stages = hand.options.stages;
      const std::string_view name = left_out;
      (name == "input" ? stages.input : name == "hands" ? stages.hands : stages.deform) = false;
      DeformLoop loop = hand.loop();
      hand.ring.try_push(test::bent_sample(Side::right, 20, HostClock::now()));
      loop.tick(0, HostClock::now());
      loop.frames().update();
      deform::Points vertices;
      loop.changes().layout().unpack(loop.frames().front().shape, vertices);
      CHECK(vertices == hand.model.vertices);
      CHECK(loop.stats().samples[1] == (name == "input" ? 0 : 1));
    }
  }

  TEST_CASE("paced by samples, each is shown without waiting for another or for a deadline") {
    OneHand hand;
    TickRing records(1024);
    hand.options.records = &records;
    hand.options.policy = OverrunPolicy::sample;
    hand.options.longest_wait = 1h; // a wake-up that was lost would show
    DeformLoop loop = hand.loop();
    std::atomic<bool> stop{false};
    std::thread thread([&] { loop.run(stop); });
    const HostTime end = HostClock::now() + 60s;
    std::uint64_t shown = 0;
    for (std::uint64_t sent = 1; sent <= 50; ++sent) {
      hand.ring.try_push(
          test::bent_sample(Side::right, static_cast<int>(sent % 20), HostClock::now()));
      while (shown < sent && HostClock::now() < end) {
        if (loop.frames().update()) shown = loop.frames().front().hands[1].samples;
        std::this_thread::yield();
      }
    }
    CHECK(shown == 50);
    stop = true;
    hand.event_count.notify();
    thread.join();
    CHECK(loop.stats().ticks == 50);
    CHECK(loop.stats().missed == 0);
    records.drain([](const TickRecord& record) noexcept {
      CHECK(record.samples == 1);
      CHECK(record.scheduled == record.input); // when the sample came is when it was due
    });
  }
}

} // namespace tick_record_test
