#include "drivers.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/driver/simulated_glove.hpp>

#include "simulated/typical_wearer.hpp"
#include "support/eventually.hpp"
#include "support/required.hpp"

namespace simulated_driver_test {

using namespace std::chrono_literals;
using nendo::Errc;
using nendo::GloveSample;
using nendo::HostClock;
using nendo::SampleRing;
using nendo::Sensor;
using nendo::Side;
using nendo::driver::DeviceSpec;
using nendo::driver::Glove;
using nendo::driver::open_simulated;
using nendo::test::require_ok;

TEST_SUITE("simulated_driver") {
  namespace {
  DeviceSpec spec(const std::string& motion = "",
                  const std::map<std::string, std::string>& options = {}) {
    return {"sim:" + motion, "sim", motion, options};
  }

  std::vector<GloveSample> run(Glove& glove, std::size_t count) {
    SampleRing ring(1024);
    require_ok(glove.start(ring));
    std::vector<GloveSample> samples;
    const auto deadline = HostClock::now() + 10s;
    while (samples.size() < count && HostClock::now() < deadline) {
      ring.drain([&](const GloveSample& sample) { samples.push_back(sample); });
      std::this_thread::sleep_for(1ms);
    }
    glove.stop();
    REQUIRE(samples.size() >= count);
    return samples;
  }
  } // namespace

  TEST_CASE("without options it is a right or left 22-sensor glove at 90 Hz, as the caller wants") {
    const auto glove = open_simulated(spec(), Side::left);
    REQUIRE(glove);
    const auto& info = (*glove)->info();
    CHECK(info.source == "sim:");
    CHECK(info.side == Side::left);
    CHECK(info.sensors == nendo::sensors_22);
    CHECK(info.rate_hz == 90.0);
  }

  TEST_CASE("options choose hand, sensors, rate and seed") {
    const auto glove = open_simulated(
        spec("pinch", {{"hand", "right"}, {"sensors", "18"}, {"rate", "500"}, {"seed", "7"}}),
        Side::left);
    REQUIRE(glove);
    CHECK((*glove)->info().side == Side::right);
    CHECK((*glove)->info().sensors == nendo::sensors_18);
    CHECK((*glove)->info().rate_hz == 500.0);
    const auto samples = run(**glove, 10);
    CHECK(samples[0].side == Side::right);
    CHECK(samples[0].present == nendo::sensors_18);
    CHECK(samples[0][Sensor::index_dip].value == 0);
    CHECK(samples[0][Sensor::index_pip].value > 0);
  }

  TEST_CASE("a wrong option is a usage error that names it and what is allowed") {
    const auto message = [](const std::string& motion,
                            const std::map<std::string, std::string>& options) {
      const auto glove = open_simulated(spec(motion, options), Side::right);
      REQUIRE_FALSE(glove);
      CHECK(glove.error().code == Errc::usage);
      return glove.error().message;
    };
    CHECK(message("dance", {}).find("rest, wave, pinch, grasp, sculpt") != std::string::npos);
    CHECK(message("", {{"colour", "red"}}).find("'colour'") != std::string::npos);
    CHECK(message("", {{"rate", "0"}}).find("1 to 1000") != std::string::npos);
    CHECK(message("", {{"rate", "1001"}}).find("rate is '1001'") != std::string::npos);
    CHECK(message("", {{"rate", "nan"}}).find("1 to 1000") != std::string::npos);
    CHECK(message("", {{"rate", "90Hz"}}).find("1 to 1000") != std::string::npos);
    CHECK(message("", {{"rate", ""}}).find("1 to 1000") != std::string::npos);
    CHECK(message("", {{"seed", "-1"}}).find("whole number") != std::string::npos);
    CHECK(message("", {{"hand", "both"}}).find("left or right") != std::string::npos);
    CHECK(message("", {{"sensors", "20"}}).find("18 or 22") != std::string::npos);
  }

  TEST_CASE("a program adds motions by name, and their errors are the opening's") {
    unsigned made = 0;
    nendo::driver::GloveContext context;
    context.motions.push_back({"still", [&](const auto& options) {
                                 ++made;
                                 CHECK(options.motion == "still");
                                 CHECK(options.seed == 7);
                                 return nendo::driver::SensorMotion([](double) {
                                   return std::array<double, nendo::sensor_slots>{};
                                 });
                               }});
    context.motions.push_back(
        {"broken", [](const auto&) { return nendo::Error{Errc::bad_input, "it is broken"}; }});
    const auto still = open_simulated(spec("still", {{"seed", "7"}}), Side::right, context);
    REQUIRE(still);
    CHECK((*still)->info().model.find("motion still") != std::string::npos);
    CHECK(open_simulated(spec("sculpt"), Side::right, context));
    CHECK(made == 1);
    const auto broken = open_simulated(spec("broken"), Side::right, context);
    REQUIRE_FALSE(broken);
    CHECK(broken.error().code == Errc::bad_input);
    CHECK(broken.error().message == "it is broken");
    const auto dance = open_simulated(spec("dance"), Side::right, context);
    REQUIRE_FALSE(dance);
    CHECK(dance.error().code == Errc::usage);
    CHECK(dance.error().message.ends_with("faces, still, broken"));
    CHECK(open_simulated(spec("still"), Side::right).error().message.ends_with("faces"));
  }

  TEST_CASE(
      "a motion from elsewhere comes as a typical wearer's counts, at the samples' own times") {
    const auto options =
        nendo::driver::simulated_glove_options(spec("touch", {{"rate", "500"}}), Side::left);
    REQUIRE(options);
    CHECK(options->motion == "touch");
    CHECK(options->side == Side::left);
    constexpr auto slot = static_cast<std::size_t>(Sensor::ring_pip);
    const auto glove = nendo::driver::make_simulated_glove(*options, [](double time_s) {
      std::array<double, nendo::sensor_slots> angles{};
      angles[slot] = 2.0 * time_s;
      return angles;
    });
    const auto [offset, gain] = nendo::driver::nominal_sensor(Sensor::ring_pip);
    for (const GloveSample& sample : run(*glove, 100)) {
      const double angle_rad = gain * (sample.raw[slot].value - offset);
      const double meant_rad = 2.0 * nendo::to_seconds(sample.device_time);
      if (meant_rad > 2.0) continue; // the converter's end
      REQUIRE(std::abs(angle_rad - meant_rad) < 4.0 * gain);
      REQUIRE(sample.side == Side::left);
    }
  }

  TEST_CASE("samples are numbered, in order, and keep the rate on the average") {
    const auto glove = open_simulated(spec("sculpt", {{"rate", "200"}}), Side::right);
    REQUIRE(glove);
    const auto samples = run(**glove, 100);
    for (std::size_t n = 1; n < samples.size(); ++n) {
      REQUIRE(samples[n].sequence == samples[n - 1].sequence + 1);
      REQUIRE(samples[n].arrival > samples[n - 1].arrival);
      // The device's time lies on the grid: a late sample moves none of those after it.
      const auto apart = samples[n].device_time - samples[n - 1].device_time;
      REQUIRE(apart % std::chrono::milliseconds(5) == std::chrono::nanoseconds(0));
      REQUIRE(samples[n].measured - samples[n - 1].measured == apart);
    }
    const double took_s = nendo::to_seconds(samples.back().arrival - samples.front().arrival);
    CHECK(took_s > 0.99 * static_cast<double>(samples.size() - 1) / 200.0 - 0.02);
    const auto stats = (*glove)->stats();
    CHECK(stats.records >= samples.size());
    CHECK(stats.bytes == 0);
    CHECK(stats.bad_records == 0);
    CHECK(stats.ring_refused == 0);
  }

  TEST_CASE("two gloves of one seed give the same counts") {
    const auto first = open_simulated(spec("rest"), Side::right);
    const auto second = open_simulated(spec("rest"), Side::right);
    REQUIRE(first);
    REQUIRE(second);
    CHECK(run(**first, 1)[0].raw == run(**second, 1)[0].raw);
  }

  TEST_CASE("a full ring costs samples, which are counted") {
    const auto glove = open_simulated(spec("rest", {{"rate", "1000"}}), Side::right);
    REQUIRE(glove);
    SampleRing ring(2);
    require_ok((*glove)->start(ring));
    while ((*glove)->stats().ring_refused < 3)
      std::this_thread::sleep_for(1ms);
    (*glove)->stop();
    const auto stats = (*glove)->stats();
    CHECK(stats.records == stats.ring_refused + 2);
  }

  TEST_CASE("even a slow glove stops promptly, and starts once after each stop") {
    const auto glove = open_simulated(spec("rest", {{"rate", "1"}}), Side::right);
    REQUIRE(glove);
    SampleRing ring(16);
    HostClock::duration least = 1h; // of some: a busy machine may keep one waiting
    for (std::uint64_t round = 0; round < 5; ++round) {
      require_ok((*glove)->start(ring));
      CHECK(nendo::test::eventually([&] { return (*glove)->stats().records > round; }));
      const auto twice = (*glove)->start(ring);
      REQUIRE_FALSE(twice);
      CHECK(twice.error().code == Errc::failed);
      const auto before = HostClock::now();
      (*glove)->stop();
      (*glove)->stop();
      least = std::min(least, HostClock::now() - before);
    }
    CHECK(least < 500ms);
  }
}

} // namespace simulated_driver_test
