#include <nendo/hand/sensor_gate.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

namespace sensor_gate_test {

using namespace nendo;
using namespace nendo::hand;
using namespace std::chrono_literals;

namespace {

constexpr double tau = 6.283185307179586;
constexpr HostClock::duration period_90_hz = std::chrono::nanoseconds(11'111'111);
constexpr auto pip = static_cast<std::size_t>(Sensor::index_pip);

/// A 22-sensor glove's samples, one after another, all sensors at the same count.
struct Stream {
  SensorGate gate{};
  Calibration calibration = default_calibration();
  HostTime now{1h};
  bool has_clock = true;

  GloveSample sample(int count) const {
    GloveSample sample;
    sample.present = sensors_22;
    sample.has_device_time = has_clock;
    sample.measured = sample.arrival = now;
    sample.raw.fill(RawCount{static_cast<std::uint16_t>(count)});
    return sample;
  }
  /// What the gate makes of the next sample.
  GloveSample pass(GloveSample next, HostClock::duration later = period_90_hz) {
    now += later;
    next.measured = next.arrival = now;
    return gate.pass(next, calibration);
  }
  GloveSample pass(int count, HostClock::duration later = period_90_hz) {
    return pass(sample(count), later);
  }
  std::uint64_t spikes() const {
    std::uint64_t all = 0;
    for (const auto of_sensor : gate.spikes())
      all += of_sensor;
    return all;
  }
};

int count_at(double angle_rad) {
  return static_cast<int>(std::lround(60.0 + angle_rad / 0.0125)); // a finger's PIP, by default
}

} // namespace

TEST_SUITE("sensor_gate") {
  TEST_CASE("a flipped high bit in one sample of one sensor never gets through, and is counted") {
    std::mt19937 random(3);
    for (const unsigned bit : {6U, 7U}) { // 64 and 128 counts: 46 and 92 degrees
      Stream stream;
      for (int n = 0; n < 400; ++n) {
        const int count = count_at(0.8 + 0.6 * std::sin(tau * n / 90.0));
        GloveSample next = stream.sample(count);
        const bool damaged = n % 7 == 3;
        if (damaged) next.raw[pip].value ^= static_cast<std::uint16_t>(1U << bit);
        const GloveSample passed = stream.pass(next);
        REQUIRE(std::abs(int{passed.raw[pip].value} - count) < 10);
        for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
          if (slot != pip) REQUIRE(passed.raw[slot] == next.raw[slot]);
        }
      }
      CHECK(stream.gate.spikes()[pip] == 57); // n = 3, 10, ... 395
      CHECK(stream.spikes() == 57);
    }
  }

  TEST_CASE("a real jump is followed one sample later, and is no spike") {
    Stream stream;
    CHECK(stream.pass(60).raw[pip].value == 60);
    CHECK(stream.pass(200).raw[pip].value == 60);
    CHECK(stream.pass(200).raw[pip].value == 200);
    CHECK(stream.pass(60).raw[pip].value == 200);
    CHECK(stream.pass(65).raw[pip].value == 65);
    CHECK(stream.spikes() == 0);
  }

  TEST_CASE("nothing is ever held for two samples in a row") {
    std::mt19937 random(7);
    Stream stream;
    bool held = false;
    for (int n = 0; n < 5000; ++n) {
      const GloveSample next = stream.sample(static_cast<int>(random() % 256));
      const bool differs = stream.pass(next).raw[pip] != next.raw[pip];
      REQUIRE_FALSE((held && differs));
      held = differs;
    }
  }

  TEST_CASE("movement at a human's speed passes untouched, slow or fast, at any rate") {
    for (const double rate_hz : {30.0, 90.0, 480.0, 1000.0}) {
      for (const double peak_rad_s : {0.5, 5.0, 24.0}) {
        Stream stream;
        const double amplitude_rad = 0.8;
        for (int n = 0; n < 2000; ++n) {
          const double angle =
              0.9 + amplitude_rad * std::sin(peak_rad_s / amplitude_rad * n / rate_hz);
          const GloveSample next = stream.sample(count_at(angle));
          const auto later = from_seconds(1.0 / rate_hz);
          REQUIRE(stream.pass(next, later).raw == next.raw);
        }
        CHECK(stream.spikes() == 0);
      }
    }
  }

  TEST_CASE("samples of a clockless glove may arrive in bursts") {
    Stream stream;
    stream.has_clock = false;
    for (int n = 0; n < 500; ++n) { // two at a time, every 22 ms, at 20 rad/s
      const GloveSample next = stream.sample(count_at(0.9 + 0.8 * std::sin(25.0 * n / 90.0)));
      REQUIRE(stream.pass(next, n % 2 == 0 ? 2 * period_90_hz : 0ns).raw == next.raw);
    }
  }

  TEST_CASE("the longer since the last sample, the farther a joint may have turned") {
    for (const int jump : {40, 80, 150}) {
      Stream stream;
      stream.pass(60);
      // 0.0125 rad a count at 25 rad/s: half a millisecond a count.
      CHECK(stream.pass(60 + jump, std::chrono::microseconds(500) * jump).raw[pip].value ==
            60 + jump);
      Stream other;
      other.pass(60);
      CHECK(other.pass(60 + jump, 5ms).raw[pip].value == 60);
    }
  }

  TEST_CASE(
      "a sensor that was not there, another hand, and the first sample are taken as they are") {
    Stream stream;
    CHECK(stream.pass(10).raw[pip].value == 10);
    GloveSample absent = stream.sample(10);
    absent.present = SensorMask{0};
    stream.pass(absent);
    CHECK(stream.pass(250).raw[pip].value == 250);
    GloveSample left = stream.sample(10);
    left.side = Side::left;
    CHECK(stream.pass(left).raw[pip].value == 10);
    CHECK(stream.spikes() == 0);
  }

  TEST_CASE("after a swap a jump is judged by the gains of the glove that is there now") {
    // 25 rad/s and 11.1 ms are 0.33 rad: 33 counts at 0.01 rad a count, and 330 at a tenth of that.
    for (const double factor : {0.1, 10.0}) {
      Stream stream;
      for (auto& sensor : stream.calibration.sensors)
        sensor.gain_rad_per_count = 0.01;
      CHECK(stream.pass(100).raw[pip].value == 100);
      CHECK(stream.pass(120).raw[pip].value == 120);
      CHECK(stream.pass(160).raw[pip].value == 120); // 0.4 rad
      CHECK(stream.pass(160).raw[pip].value == 160);
      for (auto& sensor : stream.calibration.sensors)
        sensor.gain_rad_per_count *= factor;
      const auto left = [&](int count) {
        GloveSample sample = stream.sample(count);
        sample.side = Side::left;
        return stream.pass(sample).raw[pip].value;
      };
      CHECK(left(100) == 100);
      CHECK(left(120) == (factor < 1.0 ? 120 : 100)); // 0.02 rad, or 2
      left(120);
      CHECK(left(160) == (factor < 1.0 ? 160 : 120));
    }
  }

  TEST_CASE("time that runs backwards or stops, and broken gains, do no harm") {
    Stream stream;
    stream.pass(100);
    CHECK(stream.pass(102, -1h).raw[pip].value == 102);
    CHECK(stream.pass(104, 0ns).raw[pip].value == 104);
    for (const double gain : {std::numeric_limits<double>::quiet_NaN(), 0.0}) {
      stream.calibration.sensors[pip].gain_rad_per_count = gain;
      stream.pass(0);
      CHECK(stream.pass(255).raw[pip].value == 255);
    }
  }
}

} // namespace sensor_gate_test
