#include <nendo/driver/open_glove.hpp>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/driver/emulator.hpp>

#include "cyberglove/cyberglove_identity.hpp"
#include "support/scripted_port.hpp"
#include "support/temporary_folder.hpp"

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

using Clock = std::chrono::steady_clock;

/// Looks every millisecond, so that a test waits no longer than it must.
template <class Condition>
bool within(std::chrono::milliseconds time, Condition&& condition) {
  for (const auto end = Clock::now() + time; Clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(1ms);
  }
  return condition();
}

void check_conservation(const GloveStats& stats) {
  constexpr std::uint64_t longest_record = 36;
  CHECK(stats.bytes >= stats.record_bytes + stats.discarded_bytes);
  CHECK(stats.bytes - stats.record_bytes - stats.discarded_bytes < longest_record);
}

/// The n-th set bit of a mask: where value n of a record belongs.
std::size_t slot_of(SensorMask mask, unsigned n) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (mask.has(static_cast<Sensor>(slot)) && n-- == 0) return slot;
  }
  return sensor_slots;
}

Result<std::unique_ptr<Glove>> open_port(const ScriptedPort& port) {
  return open_glove("serial:" + port.path());
}

} // namespace

TEST_SUITE("cyberglove_driver") {
  TEST_CASE("a good glove says who it is and delivers every value into its slot, time-stamped") {
    for (const bool all : {true, false}) {
      CAPTURE(all);
      Script script;
      script.sensors = all ? 22 : 18;
      script.right = all;
      const ScriptedPort port(script);
      SampleRing ring(1024);
      auto glove = open_port(port);
      REQUIRE_MESSAGE(glove, glove.error().message);
      const SensorMask sensors = all ? sensors_22 : sensors_18;
      CHECK((*glove)->info().sensors == sensors);
      CHECK((*glove)->info().side == (all ? Side::right : Side::left));
      CHECK((*glove)->info().model ==
            (all ? "Scripted CyberGlove, 22 sensors" : "Scripted CyberGlove, 18 sensors"));
      CHECK((*glove)->info().source == "serial:" + port.path());
      CHECK((*glove)->info().rate_hz == doctest::Approx(90.0));

      const HostTime before = HostClock::now();
      REQUIRE((*glove)->start(ring));
      CHECK_FALSE((*glove)->start(ring));
      CHECK(within(2s, [&] { return ring.size() >= 20; }));
      (*glove)->stop();
      std::uint64_t next = 0;
      HostTime last = before;
      ring.drain([&](const GloveSample& sample) {
        CHECK(sample.sequence == next++);
        CHECK(sample.arrival >= last);
        last = sample.arrival;
        CHECK(sample.present == sensors);
        CHECK(sample.side == (*glove)->info().side);
        CHECK(sample.has_device_time);
        CHECK(sample.device_time == std::chrono::nanoseconds(568906250));
        for (unsigned k = 0; k < script.sensors; ++k) {
          CHECK(sample.raw[slot_of(sensors, k)].value == 10 + k);
        }
      });
      CHECK(last <= HostClock::now());
      check_conservation((*glove)->stats());
      CHECK((*glove)->stats().records == next);
      CHECK((*glove)->stats().bad_records <= 2); // the end of the stream, and the answer to it
    }
  }

  TEST_CASE("units that know no options, or answer them at length, work as well") {
    for (const bool knows_options : {false, true}) {
      Script script;
      script.knows_options = knows_options;
      script.long_replies = true;
      const ScriptedPort port(script);
      SampleRing ring(64);
      auto glove = open_port(port);
      REQUIRE_MESSAGE(glove, glove.error().message);
      REQUIRE((*glove)->start(ring));
      GloveSample sample;
      REQUIRE(within(2s, [&] { return ring.try_pop(sample); }));
      CHECK(sample.has_device_time == knows_options);
      CHECK(sample[Sensor::thumb_roll].value == 10);
    }
  }

  TEST_CASE("whatever else is at the port is an error that says so, within five seconds") {
    struct Case {
      Manner manner;
      const char* said;
    };
    for (const Case& wrong :
         {Case{Manner::silent, "switched on"}, Case{Manner::babbling, "like a CyberGlove"},
          Case{Manner::modem, "like a CyberGlove"},
          Case{Manner::no_glove, "no glove is plugged into it"}}) {
      Script script;
      script.manner = wrong.manner;
      const ScriptedPort port(script);
      const auto start = Clock::now();
      const auto glove = open_port(port);
      CHECK(Clock::now() - start < 5s);
      REQUIRE_FALSE(glove);
      CHECK(glove.error().code == Errc::no_device);
      CAPTURE(glove.error().message);
      CHECK(glove.error().message.find(wrong.said) != std::string::npos);
      CHECK(glove.error().message.find("serial:" + port.path()) != std::string::npos);
    }
    const auto missing = open_glove("serial:/dev/nendo-no-such-port");
    REQUIRE_FALSE(missing);
    CHECK(missing.error().code == Errc::no_device);
  }

  TEST_CASE("a full ring refuses samples, and they are counted") {
    const ScriptedPort port;
    SampleRing ring(8);
    auto glove = open_port(port);
    REQUIRE(glove);
    REQUIRE((*glove)->start(ring));
    CHECK(within(2s, [&] { return (*glove)->stats().ring_refused > 5; }));
    (*glove)->stop();
    const GloveStats stats = (*glove)->stats();
    CHECK(stats.records == stats.ring_refused + ring.size());
    check_conservation(stats);
  }

  TEST_CASE("stop is prompt, may be repeated, and the stream may be started again") {
    const ScriptedPort port;
    SampleRing ring(1024);
    auto glove = open_port(port);
    REQUIRE(glove);
    for (int round = 0; round < 2; ++round) {
      REQUIRE((*glove)->start(ring));
      CHECK(within(2s, [&] { return (*glove)->stats().records > 3; }));
      const auto start = Clock::now();
      (*glove)->stop();
      (*glove)->stop();
      CHECK(Clock::now() - start < 1s);
    }
  }

  TEST_CASE("a stream that falls silent is started again") {
    ScriptedPort port;
    SampleRing ring(4096);
    auto glove = open_port(port);
    REQUIRE(glove);
    REQUIRE((*glove)->start(ring));
    REQUIRE(within(2s, [&] { return (*glove)->stats().records > 3; }));
    port.mute = true;
    REQUIRE(within(3s, [&] { return (*glove)->stats().silences == 1; }));
    port.mute = false;
    const std::uint64_t before = (*glove)->stats().records;
    CHECK(within(6s, [&] { return (*glove)->stats().records > before + 3; }));
    (*glove)->stop();
    CHECK((*glove)->stats().silences == 1);
    CHECK((*glove)->stats().reopened == 0);
    check_conservation((*glove)->stats());
  }

  TEST_CASE("a glove that vanishes is found again at its path, even if it is another one") {
    const TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    auto first = std::make_unique<ScriptedPort>();
    std::filesystem::create_symlink(first->path(), link);
    SampleRing ring(1U << 16U);
    auto glove = open_glove("serial:" + link.string());
    REQUIRE_MESSAGE(glove, glove.error().message);
    REQUIRE((*glove)->start(ring));
    REQUIRE(within(2s, [&] { return ring.size() > 3; }));

    first.reset();
    std::filesystem::remove(link);
    std::this_thread::sleep_for(700ms);
    ring.drain([](const GloveSample&) {});
    Script small;
    small.sensors = 18;
    small.right = false;
    const ScriptedPort second(small);
    std::filesystem::create_symlink(second.path(), link);
    GloveSample sample;
    REQUIRE(within(6s, [&] { return ring.try_pop(sample); }));
    (*glove)->stop();
    CHECK((*glove)->stats().reopened == 1);
    CHECK(sample.present == sensors_18);
    CHECK(sample.side == Side::left);
    CHECK(sample[Sensor::middle_mcp].value == 10 + 6);
    check_conservation((*glove)->stats());
  }

  TEST_CASE("a glove that is swapped at its interface unit is asked anew") {
    Script script;
    script.swap_after = 50;
    const ScriptedPort port(script);
    SampleRing ring(1U << 16U);
    auto glove = open_port(port);
    REQUIRE(glove);
    REQUIRE((*glove)->start(ring));
    GloveSample sample;
    CHECK(within(6s, [&] { return ring.try_pop(sample) && sample.present == sensors_18; }));
    (*glove)->stop();
    CHECK(sample.sequence == 49); // 50 records were sent, the last of them already too short
    CHECK(sample[Sensor::ring_mcp].value == 10 + 9);
    CHECK((*glove)->stats().bad_records > 50);
    check_conservation((*glove)->stats());
  }

  TEST_CASE("stop does not wait for a glove that is away") {
    auto port = std::make_unique<ScriptedPort>();
    SampleRing ring(4096);
    auto glove = open_port(*port);
    REQUIRE(glove);
    REQUIRE((*glove)->start(ring));
    port.reset();
    std::this_thread::sleep_for(300ms);
    const auto start = Clock::now();
    (*glove)->stop();
    CHECK(Clock::now() - start < 1s);
    CHECK((*glove)->start(ring).error().code == Errc::no_device);
  }

  TEST_CASE(
      "the emulated unit, written from the device's side, and the driver understand each other") {
    for (const Side side : {Side::left, Side::right}) {
      for (const unsigned sensors : {18U, 22U}) {
        CAPTURE(name_of(side));
        CAPTURE(sensors);
        EmulatorOptions options;
        options.side = side;
        options.sensors = sensors;
        auto emulator = GloveEmulator::open(options);
        REQUIRE_MESSAGE(emulator, emulator.error().message);
        std::atomic<bool> done{false};
        std::thread server([&] { CHECK((*emulator)->serve(done)); });
        {
          SampleRing ring(1024);
          auto glove = open_glove("serial:" + (*emulator)->tty_path());
          CHECK_MESSAGE(glove, glove.error().message);
          if (glove && (*glove)->start(ring)) {
            CHECK((*glove)->info().side == side);
            CHECK((*glove)->info().sensors == (sensors == 18 ? sensors_18 : sensors_22));
            CHECK((*glove)->info().rate_hz == doctest::Approx(90.0).epsilon(0.01));
            CHECK(within(3s, [&] { return ring.size() >= 20; }));
            (*glove)->stop();
            GloveSample sample;
            CHECK(ring.try_pop(sample));
            CHECK(sample.side == side);
            CHECK(sample.has_device_time);
            check_conservation((*glove)->stats());
          }
        }
        done = true;
        server.join();
      }
    }
  }

  TEST_CASE("the period's byte order shows in its value") {
    using cyberglove::rate_of_period;
    const auto rate = [](std::array<unsigned char, 4> words) {
      return rate_of_period(std::as_bytes(std::span(words)).first<4>());
    };
    CHECK(rate({0x80, 0x04, 0x01, 0x00}) == doctest::Approx(100.0)); // 1152, 1
    CHECK(rate({0x04, 0x80, 0x00, 0x01}) == doctest::Approx(100.0));
    CHECK(rate({0x00, 0xE1, 0x02, 0x00}) == doctest::Approx(1.0)); // 57600, 2
    CHECK(rate({0xE1, 0x00, 0x00, 0x02}) == doctest::Approx(1.0));
    CHECK(rate({0x80, 0x04, 0x00, 0x00}) == 0.0); // as fast as possible
    CHECK(rate({0x00, 0x00, 0x00, 0x00}) == 0.0);
  }
}
