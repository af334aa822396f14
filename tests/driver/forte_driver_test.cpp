#include <nendo/driver/open_glove.hpp>

#include <string>

#include <doctest/doctest.h>

#include "support/glove_facts.hpp"
#include "support/required.hpp"
#include "support/stream_laws.hpp"
#include "units/forte_unit.hpp"

namespace forte_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::emulator;
using namespace nendo::test;

namespace {

Kind by_usb() {
  return {[](Side side) {
            ForteUnitOptions options;
            options.side = side;
            return std::make_unique<ForteUnit>(options);
          },
          [](const std::string& path) { return "forte:" + path; }, 15};
}

Kind by_bluetooth() {
  return {[](Side side) {
            ForteUnitOptions options;
            options.side = side;
            options.bluetooth = true;
            return std::make_unique<ForteUnit>(options);
          },
          [](const std::string& path) { return "forte:" + path + "?link=bluetooth"; }, 15};
}

// Two joints of each finger, the thumb's MCP and IP, the others' MCP and PIP: slots 1, 2, 4, 5 ...
constexpr std::uint32_t two_joints_a_finger =
    (3U << 1U) | (3U << 4U) | (3U << 8U) | (3U << 12U) | (3U << 16U);

} // namespace

TEST_SUITE("forte_driver") {
  TEST_CASE("a Forte glove is known by its records, and its hand by what the user says") {
    for (const Side side : {Side::left, Side::right}) {
      const PtyUnit port(by_usb().make(Side::right));
      const auto glove =
          required(open_glove("forte:" + port.path() + "?hand=" + std::string(name_of(side))));
      const GloveInfo& info = glove->info();
      CHECK(info.side == side);
      CHECK(info.model == "Forte Data Glove, 10 sensors");
      CHECK(info.sensors.bits == two_joints_a_finger);
      CHECK(info.counts == CountScale{127, true});
      CHECK_FALSE(info.abilities.vibration);
      CHECK(fact(info, "link") == "usb");
      CHECK(fact(info, "hand_source") == "option");
      CHECK(fact(info, "battery_raw") == "100");
    }
  }

  TEST_CASE("a Forte glove at Bluetooth sends only by command, and the error says how") {
    const PtyUnit port(by_bluetooth().make(Side::left));
    const auto silent = open_glove("forte:" + port.path());
    REQUIRE_FALSE(silent);
    CHECK(silent.error().message.find("link (usb, bluetooth)") != std::string::npos);
    const auto glove = required(open_glove("forte:" + port.path() + "?link=bluetooth", Side::left));
    CHECK(glove->info().side == Side::left);
    CHECK(fact(glove->info(), "link") == "bluetooth");
    CHECK(fact(glove->info(), "hand_source") == "caller");
  }

  TEST_CASE("a Forte glove's options that are none are usage errors that name what there is") {
    wrong_options_are_usage_errors("forte", {{"?rate=9", "baud"},
                                             {"?baud=9600", "460800, 115200"},
                                             {"?hand=up", "left"},
                                             {"?link=radio", "usb, bluetooth"}});
  }

  TEST_CASE("a hand at rest arrives in the slots of its joints") {
    ForteUnitOptions options;
    options.motion = Motion::rest;
    const GloveSample sample = sample_at_rest(std::make_unique<ForteUnit>(options), "forte");
    check_at_rest(sample, resting_knuckles, 127.0, 2.5); // tremor, and a count of 0.7 degrees
  }

  TEST_CASE("each sensor of a frame arrives in its own slot") {
    // A stream of one frame for ever, whose counts are their index in it.
    const std::string_view frame("\xF0\x01\x0B\x0A\x0B\x0C\x0D\x0E\x0F\x10\x11\x12\x13\x64\xF7");
    const PtyUnit port(std::make_unique<Stranger>(frame));
    SampleRing ring(64);
    auto glove = required(open_glove("forte:" + port.path()));
    test::require_ok(glove->start(ring));
    GloveSample sample;
    REQUIRE(eventually([&] { return ring.try_pop(sample); }));
    glove->stop();
    int place = 10;
    for (const Sensor sensor :
         {Sensor::thumb_mcp, Sensor::thumb_ip, Sensor::index_mcp, Sensor::index_pip,
          Sensor::middle_mcp, Sensor::middle_pip, Sensor::ring_mcp, Sensor::ring_pip,
          Sensor::little_mcp, Sensor::little_pip}) {
      CAPTURE(name_of(sensor));
      CHECK(sample[sensor].value == place++);
      CHECK(sample.present.has(sensor));
    }
    CHECK(sample.present.bits == two_joints_a_finger);
  }

  TEST_CASE("what does not send like a Forte glove is an error that says so") {
    no_glove_is_an_error_that_says_so(by_usb(), "x7 noise \xF0\x01\x0B\x05\xF7");
  }
  TEST_CASE("a Forte glove's samples are in order and add up") {
    for (const Kind& kind : {by_usb(), by_bluetooth()})
      samples_are_in_order_and_add_up(kind);
  }
  TEST_CASE("a full ring refuses a Forte glove's samples and they are counted") {
    a_full_ring_refuses_and_counts(by_usb());
  }
  TEST_CASE("a Forte glove stops promptly and starts again") {
    stop_is_prompt_and_start_works_again(by_usb());
  }
  TEST_CASE("a Forte glove that falls silent is started again") {
    a_silent_stream_is_started_again(by_usb());
  }
  TEST_CASE("a Forte glove stops promptly while it is silent or away") {
    stop_is_prompt_while_silent_or_away(by_usb());
  }
  TEST_CASE("a Forte glove that vanishes is found again and gets the command to send") {
    for (const Kind& kind : {by_usb(), by_bluetooth()})
      a_glove_that_vanishes_is_found_again(kind, false);
  }
}

} // namespace forte_driver_test
