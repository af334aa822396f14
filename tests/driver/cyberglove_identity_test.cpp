#include "cyberglove/cyberglove_identity.hpp"

#include <string>

#include <doctest/doctest.h>

#include "support/canned_transport.hpp"

namespace cyberglove_identity_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::driver::cyberglove;
using nendo::test::Manner;
using nendo::test::Script;
using nendo::test::UnitTransport;
using namespace std::chrono_literals;

namespace {

/// A first meeting with a unit.
struct Meeting {
  explicit Meeting(const Script& script, const Options& options = {},
                   std::optional<WordOrder> order = {})
      : transport(script),
        greeting(greet(transport, dialogue,
                       bauds_to_try(options.baud.value_or(115'200), !options.baud.has_value()))),
        greeted(check_state("port", greeting.reply, greeting.query)),
        identity(greeted ? identify(dialogue, "port", {options, greeting.baud, order})
                         : Result<Identity>(greeted.error())) {}

  std::string fact(const std::string& name) const {
    for (const DeviceFact& fact : identity->facts) {
      if (fact.name == name) return fact.value;
    }
    return "none";
  }
  const std::string& heard() const { return transport.unit.heard; }

  UnitTransport transport;
  Dialogue dialogue{transport, HostClock::now() + 4s};
  Greeting greeting;
  Result<void> greeted;
  Result<Identity> identity;
};

Script unit_that_knows_all() {
  Script script;
  script.knows_all = true;
  return script;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST_SUITE("cyberglove_identity") {
  TEST_CASE("a unit that knows all commands reports all facts, quickly") {
    Script script = unit_that_knows_all();
    script.cybertouch = true;
    const HostTime start = HostClock::now();
    const Meeting met(script);
    CHECK(HostClock::now() - start < 1s);
    REQUIRE_MESSAGE(met.identity, met.identity.error().message);
    const std::string zeros = [] {
      std::string text;
      for (int k = 0; k < 22; ++k)
        text += " 0";
      return text;
    }();
    std::string tens;
    for (int k = 0; k < 22; ++k)
      tens += " 10";
    struct Fact {
      const char* name;
      std::string value;
    };
    for (const Fact& fact : {Fact{"information", "Scripted CyberGlove / second line"},
                             Fact{"firmware", "2.1"},
                             Fact{"sensors", "22"},
                             Fact{"hardware_mask", "0x7FFF7F"},
                             Fact{"software_mask", "0xFFFFFF"},
                             Fact{"values", "22"},
                             Fact{"hand", "right"},
                             Fact{"baud", "115200"},
                             Fact{"baud_register", "0x10 (38400 baud)"},
                             Fact{"filter", "on"},
                             Fact{"time_stamp", "on"},
                             Fact{"status_byte", "on"},
                             Fact{"switch_drives_light", "on"},
                             Fact{"quantised", "off"},
                             Fact{"wrist_switch", "off"},
                             Fact{"light", "off"},
                             Fact{"cybertouch", "yes"},
                             Fact{"vibration", "0 1 2 3 4 255"},
                             Fact{"period_ticks", "1280 1"},
                             Fact{"rate_hz", "90"},
                             Fact{"record_bytes", "30"},
                             Fact{"line_limit_hz", "384.0"},
                             Fact{"hardware_calibration", "offsets" + tens + ", gains" + zeros}}) {
      CAPTURE(fact.name);
      CHECK(met.fact(fact.name) == fact.value);
    }
    CHECK(met.identity->facts.size() == 24);
    CHECK(met.identity->model == "Scripted CyberGlove, 22 sensors");
    CHECK(met.identity->abilities.wrist_switch);
    CHECK(met.identity->abilities.light);
    CHECK(met.identity->abilities.vibration);
    CHECK(met.identity->notes.empty());
  }

  TEST_CASE("an old unit that knows only the basic commands opens as well") {
    Script script;
    script.knows_options = false;
    script.knows_rate = false;
    script.sensors = 18;
    script.right = false;
    const Meeting met(script);
    REQUIRE_MESSAGE(met.identity, met.identity.error().message);
    CHECK(met.identity->channels.sensors() == sensors_18);
    CHECK(met.identity->side == Side::left);
    CHECK(met.identity->shape.bytes() == 20);
    CHECK(met.identity->rate_hz == 0.0);
    CHECK_FALSE(met.identity->abilities.light);
    CHECK_FALSE(met.identity->abilities.wrist_switch);
    CHECK(met.fact("firmware") == "none");
    CHECK(met.fact("filter") == "none");
  }

  TEST_CASE("questions that are met with silence do not add up") {
    Script script = unit_that_knows_all();
    script.never_answered = "ivVPFDUJQWLBAC";
    const HostTime start = HostClock::now();
    const Meeting met(script);
    CHECK(HostClock::now() - start < 3s); // fourteen would take four
    REQUIRE_MESSAGE(met.identity, met.identity.error().message);
    CHECK(met.identity->model == "CyberGlove, 22 sensors");
    CHECK(contains(met.heard(), "?i?v")); // and no more of these
    CHECK_FALSE(contains(met.heard(), "?P"));
  }

  TEST_CASE("options are set, and reported") {
    Options options;
    options.rate_hz = 100.0;
    options.mask = SensorMask{0x00000F};
    options.filter = false;
    options.quantised = true;
    options.stamps = false;
    for (const bool long_replies : {false, true}) {
      Script script = unit_that_knows_all();
      script.long_replies = long_replies;
      const Meeting met(script, options);
      REQUIRE_MESSAGE(met.identity, met.identity.error().message);
      CHECK(contains(met.heard(), std::string("M\x0F\0\0N\x04", 6)));
      CHECK(contains(met.heard(), std::string("F\0Q\x01", 4)));
      CHECK(contains(met.heard(), std::string("D\0U\0", 4)));
      CHECK(contains(met.heard(), "t 1152 1\r?T"));
      CHECK(met.identity->channels.sensors() == SensorMask{0x00000F});
      CHECK(met.identity->shape.bytes() == 6);
      CHECK(met.identity->rate_hz == 100.0);
      CHECK(met.fact("filter") == "off");
      CHECK(met.fact("quantised") == "on");
      CHECK(met.fact("time_stamp") == "off");
      CHECK(met.fact("software_mask") == "0x00000F");
      CHECK(met.fact("rate_hz") == "100");
    }
  }

  TEST_CASE("the byte order of the period is found once and remembered") {
    for (const bool low_first : {false, true}) {
      Script script = unit_that_knows_all();
      script.low_first = low_first;
      Options options;
      options.rate_hz = 450.0; // 256 ticks once: 00 01 in one order and 01 00 in the other
      options.stamps = false;
      const Meeting met(script, options);
      REQUIRE_MESSAGE(met.identity, met.identity.error().message);
      const WordOrder order = low_first ? WordOrder::low_first : WordOrder::high_first;
      CHECK(met.identity->word_order == order);
      CHECK(met.identity->rate_hz == 450.0);

      const Meeting again(script, {}, order);
      REQUIRE(again.identity);
      CHECK(again.identity->word_order == order);
      CHECK(again.identity->rate_hz == doctest::Approx(90.0));
    }
  }

  TEST_CASE("what the unit refuses is a usage error that names the option and the reason") {
    const auto refused = [](const Script& script, const Options& options) {
      const Meeting met(script, options);
      REQUIRE_FALSE(met.identity);
      CHECK(met.identity.error().code == Errc::usage);
      CHECK(met.identity.error().message.starts_with("port: "));
      return met.identity.error().message;
    };
    Options filter;
    filter.filter = false;
    CHECK(contains(refused({}, filter), "filter=off: the interface unit does not know this (e?)"));
    Options rate;
    rate.rate_hz = 150.0;
    Script slow = unit_that_knows_all();
    slow.fastest_hz = 112;
    CHECK(contains(refused(slow, rate), "rate=150: the interface unit cannot sample as fast (es)"));
    Script old;
    old.knows_rate = false;
    CHECK(contains(refused(old, rate), "does not know this (e?)"));
    Options mask;
    mask.mask = SensorMask{1U << 7U};
    CHECK(contains(refused(unit_that_knows_all(), mask), "it has 0x7FFF7F"));
    Options hires;
    hires.hires = true;
    CHECK(contains(refused(unit_that_knows_all(), hires), "hires=on: the interface unit does not"));
  }

  TEST_CASE("a rate beyond the line is refused before anything is set") {
    Options options;
    options.rate_hz = 500.0;
    const Meeting met(unit_that_knows_all(), options);
    REQUIRE_FALSE(met.identity);
    CHECK(met.identity.error().message.starts_with("port: rate=500: a record of 24 bytes"));
    CHECK_FALSE(contains(met.heard(), "t "));
    CHECK_FALSE(contains(met.heard(), "D"));
  }

  TEST_CASE("stamps that do not fit are switched off, with a note") {
    Script script = unit_that_knows_all();
    script.baud = 9600;
    Options options;
    options.rate_hz = 40.0;
    const Meeting met(script, options);
    REQUIRE_MESSAGE(met.identity, met.identity.error().message);
    CHECK(met.greeting.baud == 9600);
    CHECK(met.identity->shape.bytes() == 24);
    REQUIRE(met.identity->notes.size() == 1);
    CHECK(contains(met.identity->notes[0], "9600 baud"));
    CHECK(contains(met.heard(), std::string("D\0U\0", 4)));
  }

  TEST_CASE("a CyberGlove III sends 12-bit records where it is asked to") {
    Script script = unit_that_knows_all();
    script.third = true;
    Options options;
    options.hires = true;
    options.rate_hz = 120.0;
    const Meeting met(script, options);
    REQUIRE_MESSAGE(met.identity, met.identity.error().message);
    CHECK(contains(met.heard(), "1eu1m\x04"));
    CHECK(met.identity->hires);
    CHECK(met.identity->rate_hz == 120.0);
    CHECK(met.identity->channels.sensors() == sensors_22);
    CHECK(met.fact("record_bytes") == "61");
  }

  TEST_CASE("the greeting finds the rate at which the unit answers, the likeliest at once") {
    for (const unsigned baud : {115200U, 38400U, 19200U, 9600U}) {
      Script script;
      script.baud = baud;
      const HostTime start = HostClock::now();
      const Meeting met(script);
      REQUIRE_MESSAGE(met.identity, met.identity.error().message);
      CHECK(met.greeting.baud == static_cast<int>(baud));
      CHECK(met.fact("baud") == std::to_string(baud));
      CHECK(HostClock::now() - start < 4s);
      if (baud == 115200) CHECK(met.heard().starts_with("\x03?G?S")); // asked once
    }
  }

  TEST_CASE(
      "no answer at any rate says which were tried, and a rate that was named is the only one") {
    Script script;
    script.baud = 4800;
    const HostTime start = HostClock::now();
    const Meeting met(script);
    CHECK(HostClock::now() - start < 30s);
    REQUIRE_FALSE(met.identity);
    CHECK(met.identity.error().code == Errc::no_device);
    CHECK(met.identity.error().message.starts_with(
        "port: no answer to ?G at 115200, 38400, 19200 or 9600 baud; "));

    Options options;
    options.baud = 19200;
    const Meeting named(script, options);
    REQUIRE_FALSE(named.identity);
    CHECK(named.identity.error().message.starts_with("port: no answer to ?G at 19200 baud; "));
  }

  TEST_CASE("leftovers of other programs do not disturb the start") {
    using namespace std::string_literals;
    for (const std::string& waiting :
         {"e?\0"s, "e?\0e?\0e?\0"s, "AT\r\nAT+GCAP\r\n"s, "\x11\x03\0"s, "?G"s}) {
      for (const bool streaming : {false, true}) {
        CAPTURE(waiting);
        CAPTURE(streaming);
        Script script;
        script.waiting = waiting;
        script.streaming = streaming;
        const Meeting met(script);
        REQUIRE_MESSAGE(met.identity, met.identity.error().message);
        CHECK(met.identity->channels.sensors() == sensors_22);
      }
    }
  }
}

} // namespace cyberglove_identity_test
