#include <nendo/hand/pose_capture.hpp>

#include <cmath>
#include <functional>
#include <initializer_list>
#include <random>

#include <doctest/doctest.h>

namespace pose_capture_test {

using namespace nendo;
using namespace nendo::hand;
using namespace std::chrono_literals;

namespace {

constexpr auto pip = static_cast<std::size_t>(Sensor::index_pip);

/// A 22-sensor glove, one sensor of which says what a function of time says, all others 100.
struct Stream {
  CountScale scale{};
  double rate_hz = 90.0;
  PoseCapture capture{scale};
  HostTime now{1h};

  GloveSample sample(double counts) const {
    GloveSample sample;
    sample.arrival = sample.measured = now;
    sample.raw.fill(RawCount{static_cast<std::uint16_t>(scale.max_count * 100 / 255)});
    sample.present = sensors_22;
    sample.raw[pip].value = static_cast<std::uint16_t>(std::lround(counts));
    return sample;
  }
  /// The last state after `seconds` of it.
  CaptureState run(double seconds, const std::function<double(double)>& counts_at) {
    const auto period = from_seconds(1.0 / rate_hz);
    for (double t = 0.0; t < seconds; t += 1.0 / rate_hz) {
      now += period;
      capture.push(sample(counts_at(t)));
    }
    return capture.state();
  }
  CaptureState rest(double seconds, double counts) {
    return run(seconds, [counts](double) { return counts; });
  }
};

} // namespace

TEST_SUITE("pose_capture") {
  TEST_CASE("a hand at rest for a second is held, at any rate and scale, and not before") {
    for (const double rate_hz : {30.0, 90.0, 480.0}) {
      for (const std::uint16_t most :
           std::initializer_list<std::uint16_t>{100, 255, 1000, 4095, 65535}) {
        CAPTURE(rate_hz);
        CAPTURE(most);
        Stream stream{{most, false}, rate_hz};
        CHECK(stream.capture.state() == CaptureState::waiting);
        CHECK(stream.rest(0.9, most / 2.0) == CaptureState::settling);
        CHECK(stream.capture.progress() > 0.8);
        CHECK(stream.capture.progress() < 1.0);
        CHECK(stream.rest(0.2, most / 2.0) == CaptureState::held);
        CHECK(stream.capture.progress() == 1.0);
        CHECK(stream.capture.held().present == sensors_22);
        CHECK(stream.capture.held().mean_counts[pip] == std::lround(most / 2.0));
      }
    }
  }

  TEST_CASE("mean and noise are those of the samples") {
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0.0, 0.8);
    Stream stream{{4095, false}, 480.0};
    double sum = 0.0, squares = 0.0;
    int n = 0;
    while (stream.capture.state() != CaptureState::held) {
      const GloveSample sample = stream.sample(2000.0 + 10.0 * noise(random));
      stream.now += 2ms;
      GloveSample timed = sample;
      timed.arrival = timed.measured = stream.now;
      stream.capture.push(timed);
      sum += sample.raw[pip].value;
      squares += std::pow(sample.raw[pip].value, 2);
      REQUIRE(++n < 600);
    }
    const double mean = sum / n;
    CHECK(stream.capture.held().mean_counts[pip] == doctest::Approx(mean));
    CHECK(stream.capture.held().noise_counts[pip] ==
          doctest::Approx(std::sqrt(squares / n - mean * mean)).epsilon(1e-6));
  }

  TEST_CASE("a last bit that flickers is rest, in 8 bits and in coarser scales") {
    for (const std::uint16_t most : std::initializer_list<std::uint16_t>{100, 255}) {
      Stream stream{{most, false}};
      int n = 0;
      CHECK(stream.run(1.2, [&](double) { return 50.0 + n++ % 2; }) == CaptureState::held);
      CHECK(stream.capture.held().mean_counts[pip] == doctest::Approx(50.5).epsilon(0.001));
    }
  }

  TEST_CASE("a joint that moves, fast or slowly, is moving, and is named") {
    for (const double counts_a_second : {10.0, 50.0, 300.0}) {
      CAPTURE(counts_a_second);
      Stream stream;
      bool moving = false;
      stream.run(200.0 / counts_a_second, [&](double t) {
        if (stream.capture.state() == CaptureState::moving) {
          moving = true;
          CHECK(stream.capture.troubled().bits == 1U << pip);
        }
        REQUIRE(stream.capture.state() != CaptureState::noisy);
        REQUIRE(stream.capture.state() != CaptureState::held);
        return 20.0 + counts_a_second * t;
      });
      CHECK(moving);
      CHECK(stream.rest(1.3, 120.0) == CaptureState::held);
    }
  }

  TEST_CASE("a sensor that jumps to and fro is noisy, and is named") {
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0.0, 6.0);
    Stream stream;
    int noisy = 0, other = 0;
    stream.run(5.0, [&](double) {
      const CaptureState state = stream.capture.state();
      REQUIRE(state != CaptureState::held);
      ++(state == CaptureState::noisy ? noisy : other);
      return 120.0 + noise(random);
    });
    CHECK(noisy > 4 * other);
  }

  TEST_CASE("a bare converter at either end of its counts is saturated, and a whole range is not") {
    for (const double counts : {0.0, 1.0, 255.0}) {
      CAPTURE(counts);
      Stream stream;
      CHECK(stream.rest(3.0, counts) == CaptureState::saturated);
      CHECK(stream.capture.troubled().bits == 1U << pip);
      CHECK(stream.capture.progress() == 0.0);
      Stream calibrated{{255, true}};
      CHECK(calibrated.rest(1.2, counts) == CaptureState::held);
    }
  }

  TEST_CASE("the next pose must differ from the last one, by one sensor at least") {
    Stream stream;
    CHECK(stream.rest(1.2, 100.0) == CaptureState::held);
    CHECK(stream.rest(5.0, 200.0) == CaptureState::held); // nothing changes any more
    CHECK(stream.capture.held().mean_counts[pip] == 100.0);
    stream.capture.begin_next();
    CHECK(stream.capture.progress() == 0.0);
    CHECK(stream.rest(4.0, 102.0) == CaptureState::unchanged);
    CHECK(stream.rest(1.3, 130.0) == CaptureState::held);
    CHECK(stream.capture.held().mean_counts[pip] == 130.0);
  }

  TEST_CASE("neither a pause of the stream nor a clock that runs backwards is rest") {
    Stream stream;
    stream.rest(0.5, 100.0);
    stream.now += 10s;
    CHECK(stream.rest(0.5, 100.0) == CaptureState::settling);
    stream.now -= 10s;
    CHECK(stream.rest(0.9, 100.0) == CaptureState::settling);
    CHECK(stream.rest(0.2, 100.0) == CaptureState::held);
  }

  TEST_CASE("a glove without sensors is waited for, and one that changes restarts it") {
    Stream stream;
    GloveSample bare = stream.sample(100.0);
    bare.present = {};
    CHECK(stream.capture.push(bare) == CaptureState::waiting);
    stream.rest(0.9, 100.0);
    GloveSample other = stream.sample(100.0);
    other.present = sensors_18;
    CHECK(stream.capture.push(other) == CaptureState::settling);
    CHECK(stream.capture.progress() < 0.1);
  }

  TEST_CASE("whatever is streamed, progress stays between 0 and 1, and 1 means held") {
    std::mt19937 random(11);
    for (const std::uint16_t most : std::initializer_list<std::uint16_t>{0, 1, 255, 65535}) {
      Stream stream{{most, random() % 2 == 0}};
      for (int n = 0; n < 3000; ++n) {
        GloveSample sample = stream.sample(100.0);
        for (auto& raw : sample.raw)
          raw.value = static_cast<std::uint16_t>(n % 500 < 200 ? random() : 7);
        if (random() % 100 == 0) sample.present.bits = static_cast<std::uint32_t>(random());
        stream.now += std::chrono::milliseconds(random() % 30);
        sample.arrival = sample.measured = stream.now;
        const CaptureState state = stream.capture.push(sample);
        REQUIRE(stream.capture.progress() >= 0.0);
        REQUIRE(stream.capture.progress() <= 1.0);
        REQUIRE((stream.capture.progress() == 1.0) == (state == CaptureState::held));
        if (state == CaptureState::held) stream.capture.begin_next();
      }
    }
  }
}

} // namespace pose_capture_test
