#include <nendo/driver/open_glove.hpp>

#include <string>

#include <doctest/doctest.h>

#include "support/glove_facts.hpp"
#include "support/stream_laws.hpp"
#include "units/fivedt_unit.hpp"

namespace fivedt_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::emulator;
using namespace nendo::test;

namespace {

Kind wired() {
  return {[](Side side) {
            FiveDtUnitOptions options;
            options.side = side;
            return make_fivedt_unit(options);
          },
          [](const std::string& path) { return "5dt:" + path; }, 9};
}

Kind ten_bytes() {
  Kind kind = wired();
  kind.make = [](Side side) {
    FiveDtUnitOptions options;
    options.side = side;
    options.ten_bytes = true;
    return make_fivedt_unit(options);
  };
  return kind;
}

Kind wireless() {
  return {[](Side side) {
            FiveDtUnitOptions options;
            options.side = side;
            options.rate_hz = 90.0;
            options.wireless = true;
            return make_fivedt_unit(options);
          },
          [](const std::string& path) { return "5dt:" + path + "?baud=9600"; }, 9};
}

constexpr std::uint32_t five_knuckles =
    (1U << 1U) | (1U << 4U) | (1U << 8U) | (1U << 12U) | (1U << 16U);

} // namespace

TEST_SUITE("fivedt_driver") {
  TEST_CASE("a wired glove says who it is, of either hand") {
    for (const Side side : {Side::left, Side::right}) {
      const PtyUnit port(wired().make(side));
      // Its own word goes before what the user says.
      const auto glove = required(open_glove("5dt:" + port.path() + "?hand=right", Side::right));
      const GloveInfo& info = glove->info();
      CHECK(info.side == side);
      CHECK(info.model == "DataGlove 5, 5 sensors");
      CHECK(info.sensors.bits == five_knuckles); // no wrist: the tilt sensor knows nothing of it
      CHECK(info.counts == CountScale{255, true});
      CHECK_FALSE(info.abilities.resistance);
      CHECK(fact(info, "firmware") == "2.3");
      CHECK(fact(info, "tilt_sensor") == "yes");
      CHECK(fact(info, "link") == "wired");
      CHECK(fact(info, "hand_source") == "glove");
    }
  }

  TEST_CASE("a wireless glove is known by its samples, and its hand by what the user says") {
    for (const Side side : {Side::left, Side::right}) {
      const PtyUnit port(wireless().make(Side::right));
      const std::string hand(name_of(side));
      const auto glove = required(open_glove("5dt:" + port.path() + "?baud=9600&hand=" + hand));
      CHECK(glove->info().side == side);
      CHECK(glove->info().model == "5DT Data Glove 5, 5 sensors");
      CHECK(glove->info().sensors.bits == five_knuckles);
      CHECK(fact(glove->info(), "link") == "wireless");
      CHECK(fact(glove->info(), "hand_source") == "option");
    }
  }

  TEST_CASE("a glove that somebody left streaming is asked all the same") {
    const PtyUnit port(wired().make(Side::left));
    SampleRing ring(1U << 14U);
    {
      const int other = ::open(port.path().c_str(), O_RDWR | O_NOCTTY);
      REQUIRE(::write(other, "D", 1) == 1);
      std::this_thread::sleep_for(100ms); // some samples stand in the line
      ::close(other);
    }
    auto glove = required(open_glove("5dt:" + port.path()));
    CHECK(glove->info().side == Side::left);
    REQUIRE(glove->start(ring));
    CHECK(eventually([&] { return ring.size() > 3; }));
  }

  TEST_CASE("a 5DT glove's options that are none are usage errors that name what there is") {
    wrong_options_are_usage_errors(
        "5dt", {{"?rate=9", "baud"}, {"?baud=115200", "19200, 9600"}, {"?hand=up", "left"}});
  }

  TEST_CASE("a hand at rest arrives in the slots of its knuckles") {
    FiveDtUnitOptions options;
    options.motion = Motion::rest;
    const GloveSample sample = sample_at_rest(make_fivedt_unit(options), "5dt");
    check_at_rest(sample, resting_knuckles, 255.0, 2.0); // tremor
  }

  TEST_CASE("what does not answer like a wired 5DT glove is an error that says so") {
    no_glove_is_an_error_that_says_so(wired(), "x7 noise \x55 BR");
  }
  TEST_CASE("what does not send like a wireless 5DT glove is an error that says so") {
    no_glove_is_an_error_that_says_so(wireless(), "x7 noise \x55 BR");
  }
  TEST_CASE("a 5DT glove's samples are in order and add up") {
    for (const Kind& kind : {wired(), ten_bytes(), wireless()})
      samples_are_in_order_and_add_up(kind);
  }
  TEST_CASE("a full ring refuses a 5DT glove's samples and they are counted") {
    a_full_ring_refuses_and_counts(wired());
  }
  TEST_CASE("a 5DT glove stops promptly and starts again") {
    for (const Kind& kind : {wired(), wireless()})
      stop_is_prompt_and_start_works_again(kind);
  }
  TEST_CASE("a 5DT glove that falls silent is started again") {
    a_silent_stream_is_started_again(ten_bytes());
  }
  TEST_CASE("a 5DT glove stops promptly while it is silent or away") {
    stop_is_prompt_while_silent_or_away(wired());
  }
  TEST_CASE("a 5DT glove that vanishes is found again, even if it is the other hand's") {
    a_glove_that_vanishes_is_found_again(wired(), true);
    a_glove_that_vanishes_is_found_again(wireless(), false);
  }
}

} // namespace fivedt_driver_test
