#include <nendo/driver/open_glove.hpp>

#include <memory>
#include <optional>
#include <span>
#include <string>

#include <doctest/doctest.h>

#include "support/glove_facts.hpp"
#include "support/required.hpp"
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
            return std::make_unique<FiveDtUnit>(options);
          },
          [](const std::string& path) { return "5dt:" + path; }, 9};
}

Kind ten_bytes() {
  Kind kind = wired();
  kind.make = [](Side side) {
    FiveDtUnitOptions options;
    options.side = side;
    options.ten_bytes = true;
    return std::make_unique<FiveDtUnit>(options);
  };
  return kind;
}

Kind wireless() {
  return {[](Side side) {
            FiveDtUnitOptions options;
            options.side = side;
            options.rate_hz = 90.0;
            options.wireless = true;
            return std::make_unique<FiveDtUnit>(options);
          },
          [](const std::string& path) { return "5dt:" + path + "?baud=9600"; }, 9};
}

/// A port with one sample for ever, whose counts are their index in it, and the glove's answer to
/// G.
class OneSample final : public EmulatedUnit {
public:
  explicit OneSample(Side side) : side_(side) {}
  void receive(std::span<const std::byte> bytes, Time /*now*/) override {
    for (const std::byte byte : bytes) {
      const char command = std::to_integer<char>(byte);
      if (command == 'A') streams_ = false;
      if (command == 'A') say("\x55");
      if (command == 'D') streams_ = true;
      if (command != 'G') continue;
      std::string answer(32, '\0');
      answer.replace(0, 2, "BR");
      answer[4] = side_ == Side::right ? 1 : 0;
      say(answer);
    }
  }
  void advance(Time /*now*/) override {
    if (streams_) say("\x80\x0A\x0B\x0C\x0D\x0E\x11\x12\x0D");
  }
  std::optional<Time> next_due() const noexcept override { return std::nullopt; }

private:
  void say(const std::string& text) { send(std::as_bytes(std::span(text))); }

  const Side side_;
  bool streams_ = false;
};

constexpr std::uint32_t five_knuckles =
    (1U << 1U) | (1U << 4U) | (1U << 8U) | (1U << 12U) | (1U << 16U);

} // namespace

TEST_SUITE("fivedt_driver") {
  TEST_CASE("a wired glove says who it is, of either hand") {
    for (const Side side : {Side::left, Side::right}) {
      const PtyUnit port(wired().make(side));
      // Its own word goes before what the caller wishes.
      const auto glove = required(open_glove("5dt:" + port.path(), Side::right));
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

  TEST_CASE("the option goes before the glove's own word") {
    const PtyUnit port(wired().make(Side::right));
    const auto glove = required(open_glove("5dt:" + port.path() + "?hand=left"));
    CHECK(glove->info().side == Side::left);
    CHECK(fact(glove->info(), "hand_source") == "option");
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

  TEST_CASE("a glove that streams already is asked all the same") {
    const PtyUnit port(wired().make(Side::left));
    SampleRing ring(1U << 14U);
    {
      const int other = ::open(port.path().c_str(), O_RDWR | O_NOCTTY);
      REQUIRE(::write(other, "D", 1) == 1);
      std::this_thread::sleep_for(100ms); // some samples are in the line
      ::close(other);
    }
    auto glove = required(open_glove("5dt:" + port.path()));
    CHECK(glove->info().side == Side::left);
    test::require_ok(glove->start(ring));
    CHECK(eventually([&] { return ring.size() > 3; }));
  }

  TEST_CASE("thumb first, unless a left glove is said to be the other way round") {
    struct Case {
      Side side;
      std::string options;
      bool reversed;
      std::string said;
    };
    for (const Case& c :
         {Case{Side::right, "", false, "thumb first"},
          Case{Side::right, "?left_first=little", false, "thumb first"},
          Case{Side::left, "", false, "thumb first; if that is the wrong way round"},
          Case{Side::left, "?left_first=thumb", false, "thumb first; if that is the wrong way"},
          Case{Side::left, "?left_first=little", true, "little finger first"}}) {
      CAPTURE(c.options);
      const PtyUnit port(std::make_unique<OneSample>(c.side));
      SampleRing ring(1U << 14U);
      auto glove = required(open_glove("5dt:" + port.path() + c.options));
      CHECK(glove->info().side == c.side);
      CHECK(fact(glove->info(), "finger_order").find(c.said) == 0);
      test::require_ok(glove->start(ring));
      GloveSample sample;
      REQUIRE(eventually([&] { return ring.try_pop(sample); }));
      glove->stop();
      int place = c.reversed ? 14 : 10;
      for (const Sensor sensor : {Sensor::thumb_mcp, Sensor::index_mcp, Sensor::middle_mcp,
                                  Sensor::ring_mcp, Sensor::little_mcp}) {
        CAPTURE(name_of(sensor));
        CHECK(sample[sensor].value == (c.reversed ? place-- : place++));
      }
    }
  }

  TEST_CASE("an emulated left glove that begins with the little finger rests as any other") {
    FiveDtUnitOptions options;
    options.side = Side::left;
    options.motion = Motion::rest;
    options.left_little_first = true;
    const PtyUnit port(std::make_unique<FiveDtUnit>(options));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("5dt:" + port.path() + "?left_first=little"));
    test::require_ok(glove->start(ring));
    GloveSample sample;
    REQUIRE(eventually([&] { return ring.try_pop(sample); }));
    check_at_rest(sample, resting_knuckles, 255.0, 2.0); // tremor
  }

  TEST_CASE("a 5DT glove's options that are none are usage errors that name what there is") {
    wrong_options_are_usage_errors("5dt", {{"?rate=9", "baud"},
                                           {"?baud=115200", "19200, 9600"},
                                           {"?hand=up", "left"},
                                           {"?left_first=ring", "thumb, little"}});
  }

  TEST_CASE("a hand at rest arrives in the slots of its knuckles") {
    FiveDtUnitOptions options;
    options.motion = Motion::rest;
    const GloveSample sample = sample_at_rest(std::make_unique<FiveDtUnit>(options), "5dt");
    check_at_rest(sample, resting_knuckles, 255.0, 2.0); // tremor
  }

  TEST_CASE("what does not answer like a wired 5DT glove is an error that says so") {
    no_glove_is_an_error_that_says_so(wired(), "x7 noise \x55 BR");
  }
  TEST_CASE("what does not send like a wireless 5DT glove is an error that says so") {
    no_glove_is_an_error_that_says_so(wireless(), "x7 noise \x55 BR");
  }
  TEST_CASE("the rate of a wireless glove does not count what had waited for its start") {
    what_had_waited_is_no_rate(wireless());
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
