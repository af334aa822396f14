// What a hand gets of an emulated FASTRAK whose line has faults: unit, faults, the driver's
// protocol and the tracking of wrists, by a clock of the test's own. The truth is the motion that
// the unit measures, with its noise.

#include <nendo/hand/wrist_tracking.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "fastrak/fastrak_driver.hpp"
#include "line/fault_injector.hpp"
#include "simulated/wrist_motion.hpp"
#include "support/required.hpp"
#include "transport/transport.hpp"
#include "units/fastrak_unit.hpp"

namespace tracker_faults_test {

using namespace nendo;
using namespace nendo::emulator;
using namespace std::chrono_literals;
using driver::WristMotion;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using hand::TrackingCounts;
using Time = EmulatedUnit::Time;

namespace {

constexpr std::uint32_t seed = 1;
constexpr Time switched_on = 1h;
constexpr double max_off_m = 0.015; ///< a pose from the truth

struct Setup {
  std::vector<std::string> faults;
  WristMotion motion = WristMotion::walk;
  std::vector<std::uint16_t> stations{1, 2};
};

fastrak::FastrakUnitOptions unit_of(const Setup& setup) {
  fastrak::FastrakUnitOptions options;
  options.plugged = {};
  for (const std::uint16_t station : setup.stations)
    options.plugged[station - 1U] = true;
  options.motion = setup.motion;
  options.seed = seed;
  options.noise = true;
  return options;
}

/// A line with faults, and a FASTRAK at its other end.
class FaultyLine final : public driver::Transport {
public:
  explicit FaultyLine(const Setup& setup)
      : unit(unit_of(setup)), faults(test::required(parse_faults(setup.faults)), seed) {
    unit.advance(now);
    // Centimetres; position, quaternion, CR LF.
    for (const std::string_view command : {"u", "O1,2,11,1\r", "O2,2,11,1\r"})
      write_all(std::as_bytes(std::span(command)), 0ms);
  }

  driver::ReadResult read_some(std::span<std::byte> buffer,
                               std::chrono::milliseconds /*timeout*/) noexcept override {
    const std::size_t count = std::min(buffer.size(), arrived_.size());
    std::copy_n(arrived_.begin(), count, buffer.begin());
    arrived_.erase(arrived_.begin(), arrived_.begin() + static_cast<std::ptrdiff_t>(count));
    return {count > 0 ? driver::IoStatus::done : driver::IoStatus::timeout, count};
  }
  driver::IoStatus write_all(std::span<const std::byte> bytes,
                             std::chrono::milliseconds /*timeout*/) noexcept override {
    unit.receive(bytes, now);
    collect();
    return driver::IoStatus::done;
  }
  void discard_input() noexcept override { arrived_.clear(); }

  void advance(Time time) {
    const Time end = now + time;
    for (auto due = unit.next_due(); due && *due <= end; due = unit.next_due()) {
      now = std::max(now, *due);
      unit.advance(now);
      collect();
    }
    now = end;
  }
  void unplug() { is_plugged_ = false; }
  /// Connects the line again, in the middle of a record.
  void plug_in() {
    is_plugged_ = true;
    cut_bytes_ = 20;
  }

  fastrak::FastrakUnit unit;
  FaultInjector faults;
  Time now = switched_on;

private:
  void collect() {
    auto output = unit.output();
    const std::size_t bytes = output.size();
    for (const UnitMessage& message : unit.messages()) {
      if (is_plugged_)
        faults.pass(output.first(message.bytes).subspan(std::exchange(cut_bytes_, 0)),
                    message.record, now - switched_on, arrived_);
      output = output.subspan(message.bytes);
    }
    unit.take(bytes);
  }

  std::vector<std::byte> arrived_;
  std::size_t cut_bytes_ = 0; ///< bytes that the next message lacks
  bool is_plugged_ = true;
};

/// A wrist that a station moves.
struct Wrist {
  std::uint16_t station;
  hand::WristTracking tracking{{}, Eigen::Isometry3d::Identity()};
  std::uint64_t passed = 0;
  double worst_m = 0.0; ///< a passed pose's receiver, or the wrist that it carries

  void take(const PoseSample& sample, WristMotion motion) {
    const std::uint64_t refused = tracking.counts().refused;
    tracking.take(sample);
    if (tracking.counts().refused != refused) return;
    ++passed;
    const PoseSample& pose = tracking.latest();
    const driver::ReceiverPose truth = driver::receiver_pose(
        motion, station, seed, to_seconds(pose.measured.time_since_epoch() - switched_on));
    for (const Vector3d& point_m : {Vector3d(0.0, 0.0, 0.0), wrist_m})
      worst_m = std::max(worst_m, (place_of(pose, point_m) - place_of(truth, point_m)).norm());
  }

private:
  inline static const Vector3d wrist_m = Vector3d::Map(driver::receiver_to_wrist_m.data());

  /// Returns where a point of the receiver's frame is.
  template <class Pose>
  static Vector3d place_of(const Pose& pose, const Vector3d& point_m) {
    return Vector3d::Map(pose.position_m.data()) + Quaterniond(pose.turn_xyzw.data()) * point_m;
  }
};

/// The tracker, its line and the wrists, in one thread.
class Run final : private driver::TrackerProtocol::Sink {
public:
  explicit Run(const Setup& setup)
      : line(setup), motion_(setup.motion),
        protocol_(driver::fastrak::make_protocol({setup.stations, {}})) {
    for (const std::uint16_t station : setup.stations)
      wrists.push_back({station});
    start_stream();
  }

  /// Does what the driver does after it opened the port, or reopened it.
  void start_stream() {
    test::require_ok(protocol_->start_stream(line, "fastrak", {HostTime::max(), {}}));
  }
  /// Lets time pass, in ticks of 250 Hz.
  void go(Time time) {
    constexpr Time tick = 4ms;
    for (const Time end = line.now + time; line.now < end;) {
      line.advance(tick);
      std::array<std::byte, 1024> chunk{};
      const std::size_t count = line.read_some(chunk, 0ms).count;
      protocol_->push(std::span(chunk).first(count), HostTime(line.now), *this);
      for (Wrist& wrist : wrists)
        wrist.tracking.advance(HostTime(line.now));
    }
  }

  const driver::StreamCounters& counters() const { return protocol_->counters(); }
  std::uint64_t sum(std::uint64_t TrackingCounts::* count) const {
    std::uint64_t total = 0;
    for (const Wrist& wrist : wrists)
      total += wrist.tracking.counts().*count;
    return total;
  }
  double worst_m() const {
    double worst = 0.0;
    for (const Wrist& wrist : wrists)
      worst = std::max(worst, wrist.worst_m);
    return worst;
  }

  FaultyLine line;
  std::vector<Wrist> wrists;
  std::uint64_t delivered = 0;
  std::uint64_t rejected = 0;

private:
  void deliver(PoseSample& sample) noexcept override {
    sample.arrival = HostTime(line.now);
    sample.sequence = delivered++;
    wrists[sample.station - 1U].take(sample, motion_);
  }
  void reject() noexcept override { ++rejected; }

  WristMotion motion_;
  std::unique_ptr<driver::TrackerProtocol> protocol_;
};

/// Checks that each byte and each record is accounted for, once. So many records were `cut`.
void check_counts(const Run& run, std::uint64_t cut = 0) {
  constexpr std::uint64_t record_bytes = 33;
  const driver::StreamCounters& counted = run.counters();
  CHECK(counted.bytes >= counted.record_bytes + counted.discarded_bytes);
  CHECK(counted.bytes - counted.record_bytes - counted.discarded_bytes < record_bytes);
  CHECK(counted.records == run.delivered);
  CHECK(counted.bad_records == run.rejected);
  CHECK(run.sum(&TrackingCounts::poses) == run.delivered);
  std::uint64_t passed = 0;
  for (const Wrist& wrist : run.wrists)
    passed += wrist.passed;
  CHECK(passed + run.sum(&TrackingCounts::refused) == run.delivered);
  // Only what a fault touched is missing; and the record after it, if that was the closing CR LF.
  const std::uint64_t faulted = run.line.faults.records_faulted();
  const std::uint64_t missing = run.line.faults.records() - run.delivered;
  CHECK(missing >= run.rejected);
  CHECK(missing <= faulted + faulted / 10 + cut);
}

} // namespace

TEST_SUITE("tracker_faults") {
  TEST_CASE("whatever a line does to records, no pose that passes is 15 mm from the truth") {
    const std::vector<std::string> every{"drop=0.1%", "flip=0.1%", "insert=0.1%", "lose=1%",
                                         "burst=1%"};
    std::vector<std::vector<std::string>> choices{{}, every};
    for (const std::string& fault : every)
      choices.push_back({fault});
    for (const std::vector<std::string>& faults : choices) {
      for (const Setup& setup :
           {Setup{faults, WristMotion::walk, {1, 2}}, Setup{faults, WristMotion::table, {1}}}) {
        Run run(setup);
        run.go(5min);
        const std::string name = faults.size() == 1 ? faults[0] : faults.empty() ? "none" : "every";
        CAPTURE(name);
        CHECK(run.line.faults.records() > 35'900);
        CHECK(run.worst_m() < max_off_m);
        CHECK(run.sum(&TrackingCounts::losses) == 0);
        check_counts(run);
        // Only flipped bits damage numbers in a record that stays well formed.
        const std::uint64_t refused = run.sum(&TrackingCounts::refused);
        const bool has_flips = name == "every" || name == "flip=0.1%";
        CHECK((has_flips ? refused > 80 : refused < 4));
        if (name == "none" || name == "lose=1%")
          CHECK(run.delivered == run.line.faults.records() - run.line.faults.records_faulted());
        MESSAGE(name << ", " << setup.stations.size() << " receivers: " << run.line.faults.records()
                     << " records, " << run.rejected << " bad, " << refused << " refused, worst "
                     << 1e3 * run.worst_m() << " mm");
      }
    }
  }

  TEST_CASE("after a silence, or an unplugged cable, the first pose that passes is true") {
    for (const Time length : {60ms, 300ms, 2000ms}) {
      for (const bool is_unplugged : {false, true}) {
        for (const bool is_restarted : {false, true}) {
          CAPTURE(length.count());
          CAPTURE(is_unplugged);
          const auto silence = "silence@3s+" + std::to_string(length / 1ms) + "ms";
          Run run({is_unplugged ? std::vector<std::string>{} : std::vector{silence}});
          run.go(3s);
          if (is_unplugged) run.line.unplug();
          const std::uint64_t before = run.delivered;
          run.go(length);
          CHECK(run.delivered <= before + 1);
          for (const Wrist& wrist : run.wrists)
            CHECK(wrist.tracking.is_lost() == (length > 100ms));
          if (is_unplugged) run.line.plug_in();
          if (is_restarted) run.start_stream();
          run.go(3s);
          CHECK(run.delivered > before + 350);
          CHECK(run.worst_m() < max_off_m);
          CHECK(run.sum(&TrackingCounts::refused) == 0);
          CHECK(run.sum(&TrackingCounts::losses) == (length > 100ms ? 2 : 0));
          for (const Wrist& wrist : run.wrists)
            CHECK_FALSE(wrist.tracking.is_lost());
          check_counts(run, is_unplugged ? 1 : 0);
        }
      }
    }
  }
}

} // namespace tracker_faults_test
