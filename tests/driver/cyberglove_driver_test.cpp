#include <nendo/driver/open_glove.hpp>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include <doctest/doctest.h>

#include "support/pty_host.hpp"
#include "support/required.hpp"
#include "support/scripted_port.hpp"
#include "support/stream_laws.hpp"

namespace cyberglove_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::emulator;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

using Clock = std::chrono::steady_clock;

/// The n-th set bit of a mask: where value n of a record belongs.
std::size_t slot_of(SensorMask mask, unsigned n) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (mask.has(static_cast<Sensor>(slot)) && n-- == 0) return slot;
  }
  return sensor_slots;
}

/// A good glove, for the checks that every streamed glove must pass.
struct ScriptedKind {
  static std::unique_ptr<ScriptedPort> plug(Side side) {
    Script script;
    script.right = side == Side::right;
    return std::make_unique<ScriptedPort>(script);
  }
  static std::string spec(const std::string& path) { return "serial:" + path; }
  static constexpr std::uint64_t longest_record = 36;
};

Result<std::unique_ptr<Glove>> open_port(const ScriptedPort& port) {
  return open_glove(ScriptedKind::spec(port.path()));
}

void check_conservation(const StreamStats& stats) {
  test::check_conservation(stats, ScriptedKind::longest_record);
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
      auto glove = required(open_port(port));
      const SensorMask sensors = all ? sensors_22 : sensors_18;
      CHECK(glove->info().sensors == sensors);
      CHECK(glove->info().side == (all ? Side::right : Side::left));
      CHECK(glove->info().model ==
            (all ? "Scripted CyberGlove, 22 sensors" : "Scripted CyberGlove, 18 sensors"));
      CHECK(glove->info().source == "serial:" + port.path());
      CHECK(glove->info().rate_hz == doctest::Approx(90.0));

      const HostTime before = HostClock::now();
      test::require_ok(glove->start(ring));
      CHECK_FALSE(glove->start(ring));
      CHECK(eventually([&] { return ring.size() >= 20; }));
      glove->stop();
      std::uint64_t next = 0;
      HostTime last = before;
      ring.drain([&](const GloveSample& sample) {
        const auto ticks = 0x00010002 + 1280 * static_cast<std::int64_t>(next);
        CHECK(sample.device_time == std::chrono::nanoseconds(ticks * 78125 / 9));
        CHECK(sample.measured <= sample.arrival);
        CHECK(sample.wrist_switch == WristSwitch::on); // the status byte is 0x87
        CHECK(sample.sequence == next++);
        CHECK(sample.arrival >= last);
        last = sample.arrival;
        CHECK(sample.present == sensors);
        CHECK(sample.side == glove->info().side);
        CHECK(sample.has_device_time);
        for (unsigned k = 0; k < script.sensors; ++k) {
          CHECK(sample.raw[slot_of(sensors, k)].value == 10 + k);
        }
      });
      CHECK(last <= HostClock::now());
      check_conservation(glove->stats());
      CHECK(glove->stats().records == next);
      CHECK(glove->stats().bad_records <= 2); // the end of the stream, and the answer to it
    }
  }

  TEST_CASE("units that know no options, or answer them at length, work as well") {
    for (const bool knows_options : {false, true}) {
      Script script;
      script.knows_options = knows_options;
      script.long_replies = true;
      const ScriptedPort port(script);
      SampleRing ring(64);
      auto glove = required(open_port(port));
      test::require_ok(glove->start(ring));
      GloveSample sample;
      REQUIRE(eventually([&] { return ring.try_pop(sample); }));
      CHECK(sample.has_device_time == knows_options);
      CHECK(sample[Sensor::thumb_roll].value == 10);
    }
  }

  TEST_CASE("whatever else is at the port is an error that says so, within seconds") {
    struct Case {
      Manner manner;
      const char* said;
    };
    for (const Case& wrong :
         {Case{Manner::silent, "115200, 38400, 19200 or 9600 baud; is the glove's interface unit "
                               "switched on"},
          Case{Manner::babbling, "like a CyberGlove"}, Case{Manner::modem, "like a CyberGlove"},
          Case{Manner::no_glove, "no glove is plugged into it"}}) {
      Script script;
      script.manner = wrong.manner;
      const ScriptedPort port(script);
      const auto start = Clock::now();
      const auto glove = open_port(port);
      CHECK(Clock::now() - start < 15s); // less than five, but for what else the machine does
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
    a_full_ring_refuses_and_counts(ScriptedKind{});
  }

  TEST_CASE("stop is prompt, may be repeated, and the stream may be started again") {
    stop_is_prompt_and_start_works_again(ScriptedKind{});
  }

  TEST_CASE("a stream that falls silent is started again") {
    a_silent_stream_is_started_again(ScriptedKind{});
  }

  TEST_CASE("a glove that vanishes is found again at its path, even if it is another one") {
    const TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    auto first = std::make_unique<ScriptedPort>();
    std::filesystem::create_symlink(first->path(), link);
    SampleRing ring(1U << 16U);
    auto glove = required(open_glove("serial:" + link.string()));
    test::require_ok(glove->start(ring));
    REQUIRE(eventually([&] { return ring.size() > 3; }));

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
    REQUIRE(eventually([&] { return ring.try_pop(sample); }));
    glove->stop();
    CHECK(glove->stats().reopened == 1);
    CHECK(sample.present == sensors_18);
    CHECK(sample.side == Side::left);
    CHECK(sample[Sensor::middle_mcp].value == 10 + 6);
    check_conservation(glove->stats());
  }

  TEST_CASE("a glove that is swapped at its interface unit is asked again") {
    Script script;
    script.swap_after = 50;
    const ScriptedPort port(script);
    SampleRing ring(1U << 16U);
    auto glove = required(open_port(port));
    test::require_ok(glove->start(ring));
    GloveSample sample;
    CHECK(eventually([&] { return ring.try_pop(sample) && sample.present == sensors_18; }));
    glove->stop();
    CHECK(sample.sequence == 49); // 50 records were sent, the last of them already too short
    CHECK(sample[Sensor::ring_mcp].value == 10 + 9);
    CHECK(glove->stats().bad_records >= 16); // in a row: no need to wait for a silence
    CHECK(glove->stats().silences == 0);
    check_conservation(glove->stats());
  }

  TEST_CASE("stop does not wait for a glove that is away") {
    auto port = std::make_unique<ScriptedPort>();
    SampleRing ring(4096);
    auto glove = required(open_port(*port));
    REQUIRE(eventually([&] { return static_cast<bool>(glove->start(ring)); }));
    port.reset();
    std::this_thread::sleep_for(300ms);
    const auto start = Clock::now();
    glove->stop();
    CHECK(Clock::now() - start < 1s);
    CHECK(glove->start(ring).error().code == Errc::no_device);
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
        const ServedEmulator emulator(options);
        SampleRing ring(1024);
        auto glove = required(open_glove("serial:" + emulator->tty_path()));
        test::require_ok(glove->start(ring));
        CHECK(glove->info().side == side);
        CHECK(glove->info().sensors == (sensors == 18 ? sensors_18 : sensors_22));
        CHECK(glove->info().rate_hz == doctest::Approx(90.0).epsilon(0.01));
        CHECK(eventually([&] { return ring.size() >= 20; }));
        glove->stop();
        GloveSample sample;
        CHECK(ring.try_pop(sample));
        CHECK(sample.side == side);
        CHECK(sample.has_device_time);
        check_conservation(glove->stats());
      }
    }
  }

  TEST_CASE("12-bit streams are read, paused and ended, whether their answers end in NUL or not") {
    for (const bool terminated : {false, true}) {
      CAPTURE(terminated);
      EmulatorOptions options;
      options.cyberglove.model = 3;
      options.cyberglove.hires_terminated = terminated;
      const ServedEmulator emulator(options);
      SampleRing ring(4096);
      auto glove = required(open_glove("serial:" + emulator->tty_path() + "?hires=on"));
      CHECK(glove->info().counts.max_count == 4095);
      test::require_ok(glove->start(ring));
      CHECK(eventually([&] { return ring.size() >= 20; }));
      glove->set_feedback({true, {}, {}});
      const std::uint64_t before = glove->stats().records;
      CHECK(eventually([&] { return glove->stats().records > before + 20; }));
      glove->stop();
      CHECK(glove->stats().silences == 0);
      test::require_ok(glove->start(ring));
      CHECK(eventually([&] { return glove->stats().records > 20; }));
      glove->stop();
      test::check_conservation(glove->stats(), 61);
    }
  }

  TEST_CASE("a unit is read whose own period is too short for it, and whose restart is quick") {
    EmulatorOptions options;
    options.cyberglove.overrun = true;
    options.cyberglove.restart_s = 0.25;
    options.faults = {"restart@3s"};
    const ServedEmulator emulator(options);
    SampleRing ring(4096);
    auto glove = required(open_glove("serial:" + emulator->tty_path()));
    test::require_ok(glove->start(ring));
    CHECK(eventually([&] { return glove->stats().too_fast > 20; }));
    CHECK(eventually([&] { return glove->stats().silences == 1; }));
    const std::uint64_t before = glove->stats().records;
    CHECK(eventually([&] { return glove->stats().records > before + 20; }));
    glove->stop();
    CHECK(glove->stats().too_fast == glove->stats().records);
    check_conservation(glove->stats());
  }

  TEST_CASE("options are set again after a silence and after the port went away") {
    const TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    Script script;
    script.knows_all = true;
    auto first = std::make_unique<ScriptedPort>(script);
    std::filesystem::create_symlink(first->path(), link);
    SampleRing ring(1U << 16U);
    auto glove =
        required(open_glove("serial:" + link.string() + "?rate=100&filter=off&mask=0x00000F"));
    CHECK(glove->info().rate_hz == 100.0);
    CHECK(glove->info().sensors == SensorMask{0x0F});
    test::require_ok(glove->start(ring));
    REQUIRE(eventually([&] { return glove->stats().records > 3; }));
    const auto times = [](const ScriptedPort& port) {
      const std::string heard = port.control.heard();
      std::size_t filters = 0;
      std::size_t periods = 0; // set after the filter
      for (std::size_t at = 0; at < heard.size(); ++at) {
        const std::string_view rest = std::string_view(heard).substr(at);
        if (rest.starts_with(std::string_view("F\0", 2))) ++filters;
        if (rest.starts_with("t 1152 1\r")) ++periods;
      }
      CHECK(filters >= periods);
      return periods;
    };
    CHECK(times(*first) == 1);
    first->control.power_cycle = true;
    REQUIRE(eventually([&] { return times(*first) == 2; }));
    const std::uint64_t before = glove->stats().records;
    CHECK(eventually([&] { return glove->stats().records > before + 3; }));

    first.reset();
    std::filesystem::remove(link);
    const ScriptedPort second(script);
    std::filesystem::create_symlink(second.path(), link);
    REQUIRE(eventually([&] { return times(second) == 1; }));
    REQUIRE(eventually([&] { return glove->stats().reopened == 1; }));
    ring.drain([](const GloveSample& sample) { CHECK(sample.present == SensorMask{0x0F}); });
    glove->stop();
    check_conservation(glove->stats());
  }

  TEST_CASE("a glove at another line rate is found there, and again after it came back") {
    const TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    Script script;
    script.baud = 38400;
    auto first = std::make_unique<ScriptedPort>(script);
    std::filesystem::create_symlink(first->path(), link);
    SampleRing ring(1U << 16U);
    auto opened = open_glove("serial:" + link.string());
    for (int again = 0; again < 4 && !opened; ++again) // a busy machine answers too late at a rate
      opened = open_glove("serial:" + link.string());
    auto glove = required(std::move(opened));
    test::require_ok(glove->start(ring));
    REQUIRE(eventually([&] { return glove->stats().records > 3; }));
    first.reset();
    std::filesystem::remove(link);
    const ScriptedPort second(script);
    std::filesystem::create_symlink(second.path(), link);
    CHECK(eventually([&] { return glove->stats().reopened == 1; }));
    const std::uint64_t before = glove->stats().records;
    CHECK(eventually([&] { return glove->stats().records > before + 3; }));
  }

  TEST_CASE("what a glove is to show pauses its stream, and is shown again after it came back") {
    Script script;
    script.knows_all = true;
    script.cybertouch = true;
    ScriptedPort port(script);
    SampleRing ring(1U << 16U);
    auto glove = required(open_port(port));
    CHECK(glove->info().abilities.light);
    CHECK(glove->info().abilities.vibration);
    test::require_ok(glove->start(ring));
    REQUIRE(eventually([&] { return glove->stats().records > 3; }));
    Feedback feedback;
    feedback.light = true;
    feedback.vibration = {1, 2, 3, 4, 5, 6};
    const std::string shown("\x03J\0L\x01"
                            "A\xFF\x01\x02\x03\x04\x05\x06S",
                            14);
    const auto is_shown = [&] { return port.control.heard().ends_with(shown); };
    glove->set_feedback(feedback);
    CHECK(eventually(is_shown));
    std::uint64_t before = glove->stats().records;
    CHECK(eventually([&] { return glove->stats().records > before + 3; }));
    CHECK(glove->stats().silences == 0);

    port.control.power_cycle = true;
    CHECK(eventually([&] { return glove->stats().silences >= 1; }));
    CHECK(eventually(is_shown));
    before = glove->stats().records;
    CHECK(eventually([&] { return glove->stats().records > before + 3; }));
    glove->stop();
    check_conservation(glove->stats());
  }

  TEST_CASE("a glove that has nothing to show is not disturbed") {
    const ScriptedPort port; // knows neither light nor vibrators
    SampleRing ring(1U << 16U);
    auto glove = required(open_port(port));
    CHECK_FALSE(glove->info().abilities.light);
    test::require_ok(glove->start(ring));
    REQUIRE(eventually([&] { return glove->stats().records > 3; }));
    const std::string heard = port.control.heard();
    glove->set_feedback({true, {}, {}});
    const std::uint64_t before = glove->stats().records;
    CHECK(eventually([&] { return glove->stats().records > before + 200; }));
    CHECK(port.control.heard() == heard);
  }

  TEST_CASE("a glove that is pulled from its interface unit comes back when it is plugged in") {
    ScriptedPort port;
    SampleRing ring(1U << 16U);
    auto glove = required(open_port(port));
    test::require_ok(glove->start(ring));
    REQUIRE(eventually([&] { return glove->stats().records > 3; }));
    port.control.unplugged = true;
    REQUIRE(eventually([&] { return glove->stats().silences >= 1; }));
    const std::string heard = port.control.heard();
    REQUIRE(eventually([&] { return port.control.heard().ends_with("?G"); }));
    const std::uint64_t before = glove->stats().records;
    port.control.unplugged = false;
    CHECK(eventually([&] { return glove->stats().records > before + 3; }));
    // Another one may have been plugged in: the unit was set to look.
    CHECK(port.control.heard().find('\x09', heard.size()) != std::string::npos);
    glove->stop();
    CHECK(glove->stats().silences == 1);
    check_conservation(glove->stats());
  }

  TEST_CASE("external sync is switched on last, and off at the end") {
    Script script;
    script.knows_all = true;
    const ScriptedPort port(script);
    SampleRing ring(1024);
    auto glove = required(open_glove("serial:" + port.path() + "?sync=on"));
    CHECK(glove->info().rate_hz == 0.0);
    test::require_ok(glove->start(ring));
    CHECK(eventually([&] { return port.control.heard().ends_with("Y\x01S"); }));
    glove->stop();
    // Behind it there may be one more \x03, if a busy machine answered late.
    CHECK(eventually([&] {
      const std::string heard = port.control.heard();
      const std::string off("\x03Y\0", 3);
      return heard.ends_with(off) || heard.ends_with(off + '\x03');
    }));
  }
}

} // namespace cyberglove_driver_test
