// Stuck sensors are found while a hand moves, and never while it rests or some of it moves.

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/stuck_watch.hpp>
#include <nendo/hand/wearer.hpp>

#include "reference/wearers.hpp"
#include "simulated/hand_motion.hpp"
#include "simulated/typical_wearer.hpp"

namespace stuck_watch_test {

using namespace nendo;
using hand::StuckWatch;

namespace {

constexpr double rate_hz = 90.0;

GloveSample sample_at(double time_s, const std::array<RawCount, sensor_slots>& raw,
                      SensorMask sensors = sensors_22) {
  GloveSample sample;
  sample.raw = raw;
  sample.present = sensors;
  sample.arrival = sample.measured = HostTime(from_seconds(100.0 + time_s));
  return sample;
}

/// A sensor that is stuck from a time on.
struct Stuck {
  Sensor sensor;
  std::optional<std::uint16_t> count; ///< nothing: where it was
  double from_s = 0.0;
  double to_s = 1e9;
};

/// A simulated hand in a glove with stuck sensors, watched.
struct WatchedHand {
  driver::HandMotion motion;
  driver::TypicalWearer wearer;
  SensorMask sensors;
  StuckWatch watch;
  std::array<std::optional<RawCount>, sensor_slots> held{};

  WatchedHand(driver::Motion motion_, std::uint32_t seed, SensorMask sensors_ = sensors_22,
              Side side = Side::right)
      : motion(motion_, side, seed), wearer(seed), sensors(sensors_) {}

  void pass(double from_s, double to_s, const std::vector<Stuck>& stuck = {}) {
    for (double time_s = from_s; time_s < to_s; time_s += 1.0 / rate_hz) {
      auto raw = wearer.counts(motion.at(time_s));
      for (const Stuck& one : stuck) {
        if (time_s < one.from_s || time_s >= one.to_s) continue;
        const auto slot = static_cast<std::size_t>(one.sensor);
        if (!held[slot]) held[slot] = one.count ? RawCount{*one.count} : raw[slot];
        raw[slot] = *held[slot];
      }
      watch.push(sample_at(time_s, raw, sensors));
    }
  }
};

SensorMask only(Sensor sensor) {
  SensorMask mask;
  mask.add(sensor);
  return mask;
}

template <class Visit>
void for_each_sensor(SensorMask sensors, Visit&& visit) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (sensors.has(static_cast<Sensor>(slot))) visit(static_cast<Sensor>(slot), slot);
}

} // namespace

TEST_SUITE("stuck_watch") {
  TEST_CASE("no simulated motion makes a sensor that works look stuck") {
    for (const auto motion : {driver::Motion::rest, driver::Motion::wave, driver::Motion::pinch,
                              driver::Motion::grasp, driver::Motion::sculpt, driver::Motion::faces})
      for (const SensorMask sensors : {sensors_22, sensors_18})
        for (const std::uint32_t seed : {1U, 7U}) {
          WatchedHand hand(motion, seed, sensors, seed == 1 ? Side::right : Side::left);
          hand.pass(0.0, 60.0);
          CHECK(hand.watch.stuck().bits == 0);
        }
  }

  TEST_CASE("a hand that rests shows nothing, even without a count of noise") {
    StuckWatch watch;
    std::array<RawCount, sensor_slots> raw{};
    raw.fill(RawCount{120});
    for (int n = 0; n < 6000; ++n)
      watch.push(sample_at(n / rate_hz, raw));
    CHECK(watch.stuck().bits == 0);
  }

  TEST_CASE("a finger that moves alone in a glove without noise shows nothing of the others") {
    StuckWatch watch;
    std::array<RawCount, sensor_slots> raw{};
    raw.fill(RawCount{120});
    for (int n = 0; n < 6000; ++n) {
      const double bend = 60.0 * std::sin(n / 30.0);
      for (const Sensor sensor : {Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip})
        raw[static_cast<std::size_t>(sensor)].value = static_cast<std::uint16_t>(120.0 + bend);
      watch.push(sample_at(n / rate_hz, raw));
    }
    CHECK(watch.stuck().bits == 0);
  }

  TEST_CASE("each flexion sensor that is stuck while the hand closes is found, alone") {
    for (const SensorMask sensors : {sensors_22, sensors_18}) {
      for (const std::optional<std::uint16_t> count :
           {std::optional<std::uint16_t>(255), std::optional<std::uint16_t>()}) {
        for_each_sensor(sensors, [&](Sensor sensor, std::size_t slot) {
          if (slot < 4 || slot >= 20 || slot % 4 == 3) return;
          WatchedHand hand(driver::Motion::grasp, 3, sensors);
          hand.pass(0.0, 30.0, {{sensor, count, 6.0}});
          CAPTURE(name_of(sensor));
          CHECK(hand.watch.stuck() == only(sensor));
        });
      }
    }
  }

  TEST_CASE("in a free motion of all joints each of the 22 sensors is found, and no other") {
    for_each_sensor(sensors_22, [&](Sensor sensor, std::size_t slot) {
      for (const std::uint16_t count : {std::uint16_t{0}, std::uint16_t{255}, std::uint16_t{140}}) {
        reference::Wearer wearer(2002);
        const reference::FreeMotion motion(5, wearer.ranges());
        StuckWatch watch;
        for (int n = 0; n < 40 * 90; ++n) {
          GloveSample sample = wearer.read(motion.angles_rad(n / rate_hz));
          sample.raw[slot].value = count;
          sample.arrival = sample.measured = HostTime(from_seconds(n / rate_hz));
          watch.push(sample);
        }
        CAPTURE(name_of(sensor));
        CHECK(watch.stuck() == only(sensor));
      }
    });
  }

  TEST_CASE("two are found, of one finger and of two") {
    using Pair = std::pair<Sensor, Sensor>;
    for (const Pair& pair :
         {Pair{Sensor::index_pip, Sensor::index_dip}, Pair{Sensor::ring_mcp, Sensor::ring_pip},
          Pair{Sensor::index_pip, Sensor::little_mcp},
          Pair{Sensor::middle_mcp, Sensor::ring_mcp}}) {
      const Sensor a = pair.first, b = pair.second;
      WatchedHand hand(driver::Motion::grasp, 5);
      hand.pass(0.0, 60.0, {{a, 255, 4.0}, {b, {}, 10.0}});
      CAPTURE(name_of(a));
      CAPTURE(name_of(b));
      CHECK(hand.watch.stuck().bits == (only(a).bits | only(b).bits));
    }
  }

  TEST_CASE("a sensor that moves again is stuck no more, and a bit that turns over is no motion") {
    WatchedHand hand(driver::Motion::grasp, 2);
    hand.pass(0.0, 30.0, {{Sensor::ring_pip, 255, 5.0}});
    REQUIRE(hand.watch.stuck() == only(Sensor::ring_pip));
    auto raw = hand.wearer.counts(hand.motion.at(30.0));
    raw[static_cast<std::size_t>(Sensor::ring_pip)] = RawCount{127};
    hand.watch.push(sample_at(30.0, raw));
    CHECK(hand.watch.stuck() == only(Sensor::ring_pip));
    hand.pass(30.1, 30.3, {{Sensor::ring_pip, 255, 0.0}});
    CHECK(hand.watch.stuck() == only(Sensor::ring_pip));
    hand.pass(30.4, 30.6);
    CHECK(hand.watch.stuck().bits == 0);
  }

  TEST_CASE("a glove that calibrates itself holds joints at its ends for long") {
    StuckWatch watch(CountScale{4095, true});
    std::array<RawCount, sensor_slots> raw{};
    for (int n = 0; n < 6000; ++n) {
      const double bend = 2000.0 * std::sin(n / 30.0);
      raw.fill(RawCount{static_cast<std::uint16_t>(2048.0 + bend)});
      raw[static_cast<std::size_t>(Sensor::index_pip)] = RawCount{0};
      raw[static_cast<std::size_t>(Sensor::ring_pip)] = RawCount{4095};
      watch.push(sample_at(n / rate_hz, raw));
    }
    CHECK(watch.stuck().bits == 0);
  }

  TEST_CASE("twelve bits may flicker by the last two, and still be stuck") {
    StuckWatch watch(CountScale{4095, false});
    std::array<RawCount, sensor_slots> raw{};
    for (int n = 0; n < 6000; ++n) {
      const double bend = 900.0 * std::sin(n / 30.0);
      raw.fill(RawCount{static_cast<std::uint16_t>(2048.0 + bend)});
      raw[static_cast<std::size_t>(Sensor::index_pip)] =
          RawCount{static_cast<std::uint16_t>(4092 + n % 4)};
      watch.push(sample_at(n / rate_hz, raw));
    }
    CHECK(watch.stuck() == only(Sensor::index_pip));
  }

  TEST_CASE("what is found depends on the samples alone, and continues from what was found") {
    hand::Wearer wearer;
    wearer.watched = CountScale{};
    hand::ActiveCalibration first(wearer), second(wearer);
    driver::HandMotion motion(driver::Motion::grasp, Side::right, 4);
    driver::TypicalWearer typical(4);
    std::optional<hand::ActiveCalibration> later;
    for (int n = 0; n < 40 * 90; ++n) {
      auto raw = typical.counts(motion.at(n / rate_hz));
      raw[static_cast<std::size_t>(Sensor::index_pip)] = RawCount{255};
      const GloveSample sample = sample_at(n / rate_hz, raw);
      first.follow(sample);
      second.follow(sample);
      REQUIRE(first.left_out(Side::right) == second.left_out(Side::right));
      if (n == 30 * 90) {
        REQUIRE(first.left_out(Side::right) == only(Sensor::index_pip));
        wearer.stuck = first.stuck()->stuck();
        later.emplace(wearer);
      }
      if (!later) continue;
      later->follow(sample);
      CHECK(later->left_out(Side::right) == only(Sensor::index_pip));
    }
    CHECK(first.left_out(Side::left).bits == 0); // of a glove of the other hand nothing is known
    hand::Wearer unwatched;
    hand::ActiveCalibration none(unwatched);
    CHECK(none.stuck() == nullptr);
  }
}

} // namespace stuck_watch_test
