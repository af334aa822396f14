#include "gloves/device_status.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

namespace device_status_test {

using namespace nendo;
using namespace nendo::gloves;
using namespace std::chrono_literals;

namespace {

/// A device whose counts the test sets.
template <class Device, class Info>
class Counted : public Device {
public:
  explicit Counted(Info info) : info_(std::move(info)) {}
  const Info& info() const noexcept override { return info_; }
  void stop() noexcept override {}
  driver::StreamStats stats() const noexcept override { return counted; }

  driver::StreamStats counted;

private:
  Info info_;
};
class CountedGlove final : public Counted<driver::Glove, driver::GloveInfo> {
public:
  using Counted::Counted;
  Result<void> start(SampleRing&) override { return {}; }
  void set_feedback(const driver::Feedback&) noexcept override {}
};
class CountedTracker final : public Counted<driver::Tracker, driver::TrackerInfo> {
public:
  using Counted::Counted;
  Result<void> start(std::span<const driver::StationRing>) override { return {}; }
};

/// A run with a glove on each hand, and a tracker with a station on each wrist.
struct Run {
  std::vector<OpenHand> hands;
  std::array<CountedGlove*, 2> gloves{};
  std::shared_ptr<CountedTracker> tracker;
  flow::Frame frame;
  HostTime now = HostTime(100s);
  DeviceWatch watch;

  Run() {
    driver::TrackerInfo info;
    info.source = "fastrak:/dev/ttyUSB2?station=1";
    info.model = "FASTRAK\t3.1\n";
    info.stations = {1, 2};
    info.rate_hz = 120.0;
    tracker = std::make_shared<CountedTracker>(info);
    tracker->counted.records = 400;
    for (const Side side : {Side::left, Side::right}) {
      const std::size_t slot = flow::Placement::index_of(side);
      driver::GloveInfo glove_info;
      glove_info.source = "serial:/dev/ttyUSB" + std::to_string(slot);
      glove_info.model = "CyberGlove, 22 sensors";
      auto glove = std::make_unique<CountedGlove>(glove_info);
      glove->counted.records = 359;
      glove->counted.rate_hz = 90.0;
      glove->counted.counts_missed = true;
      gloves[slot] = glove.get();
      OpenHand hand;
      hand.side = side;
      hand.glove = std::move(glove);
      const std::uint16_t station = side == Side::left ? 1 : 2;
      hand.wrist = sculpting::OpenWrist{
          nullptr, {tracker, station, "fastrak:/dev/ttyUSB2?station=" + std::to_string(station)}};
      hands.push_back(std::move(hand));
      frame.hands[slot].present = true;
      frame.hands[slot].tracked = true;
    }
  }
  DeviceStatuses look() { return watch.look(hands, frame, now); }
  /// Both hands get samples and poses at 60 Hz for that time, of which the latest is 8 ms old.
  void play(HostClock::duration time) {
    const auto period = 16'666'667ns;
    for (HostTime at = now + period; at <= now + time; at += period)
      for (flow::HandFrame& hand : frame.hands) {
        hand.newest_sample = hand.newest_pose = at;
        ++hand.pose_counts.poses;
        watch.look(hands, frame, at);
      }
    now = frame.hands[0].newest_pose + 8ms;
  }
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST_SUITE("device_status") {
  TEST_CASE("a glove and its tracker are shown by the same words, each station by its own") {
    Run run;
    run.hands[1].uncalibrated = true;
    run.play(3s);
    const auto statuses = run.look();
    for (const auto& [slot, side] : {std::pair{0U, "left"}, std::pair{1U, "right"}}) {
      REQUIRE(statuses[slot].size() == 2);
      const auto& [glove, wrist] = std::pair(statuses[slot][0], statuses[slot][1]);
      const std::string number = std::to_string(slot);
      CHECK(glove.title == std::string(side) + " glove: serial:/dev/ttyUSB" + number +
                               ": CyberGlove, 22 sensors" + (slot == 1 ? ", uncalibrated" : ""));
      CHECK(glove.state == "90.0/s, 8 ms old, 359 delivered, nothing lost");
      CHECK(contains(wrist.title, std::string(side) + " wrist: fastrak:/dev/ttyUSB2?station=" +
                                      std::to_string(slot + 1) + ": FASTRAK"));
      CHECK(wrist.state.starts_with("60.0/s, 8 ms old, 400 delivered"));
      for (const std::string& line : {glove.title, glove.state, wrist.title, wrist.state})
        CHECK(std::ranges::all_of(line, [](char c) { return c >= ' ' && c <= '~'; }));
    }
  }

  TEST_CASE("before anything comes it is said, and a silent glove and a lost wrist are") {
    Run run;
    auto statuses = run.look();
    CHECK(contains(statuses[0][0].state, "no sample yet"));
    CHECK(contains(statuses[0][1].state, "no pose yet"));
    run.play(2s);
    run.now += 3s;
    run.frame.hands[0].lost = run.frame.hands[0].silent = true;
    run.frame.hands[0].pose_counts.refused = 1;
    statuses = run.look();
    CHECK(contains(statuses[0][0].state, "silent for 3.0 s"));
    CHECK(statuses[0][1].state.starts_with("lost; "));
    CHECK(contains(statuses[0][1].state, "silent for 3.0 s"));
    CHECK(statuses[0][1].state.ends_with(", 1 pose refused by the gate"));
    CHECK_FALSE(contains(statuses[1][1].state, "lost; "));
    CHECK_FALSE(contains(statuses[1][1].state, "refused by the gate"));
  }

  TEST_CASE("the rate is that of the last second or two, also after a pause and a new beginning") {
    CountRate rate;
    CHECK(rate.per_s() == 0.0);
    HostTime time(50s);
    std::uint64_t count = 0;
    const auto play = [&](int events, HostClock::duration period) {
      for (int event = 0; event < events; ++event)
        rate.add(++count, time += period);
    };
    play(500, 4ms);
    CHECK(rate.per_s() == doctest::Approx(250.0));
    play(200, 10ms);
    CHECK(rate.per_s() == doctest::Approx(100.0));
    for (int again = 0; again < 1000; ++again)
      rate.add(count, time); // nothing came
    CHECK(rate.per_s() == doctest::Approx(100.0));
    play(100, 0s); // all at once, as records of one read
    play(1, 100ms);
    CHECK(rate.per_s() > 150.0);
    rate.add(count = 1, time = HostTime(10s));
    CHECK(rate.per_s() == 0.0);
    play(100, 20ms);
    CHECK(rate.per_s() == doctest::Approx(50.0));
  }

  TEST_CASE("a hand that only a recording plays is listed as that") {
    Run run;
    run.hands.pop_back();
    const auto statuses = run.look();
    REQUIRE(statuses[1].size() == 1);
    CHECK(statuses[1][0].title == "right glove: the recording");
    CHECK(statuses[1][0].state.empty());
  }
}

} // namespace device_status_test
