#include <nendo/driver/open_tracker.hpp>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/numbered_poses.hpp"
#include "support/tracker_laws.hpp"

namespace liberty_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;

namespace {

TrackerKind patriot() {
  return {"liberty", NENDO_LIBERTY_DEVICE, 50};
}

std::unique_ptr<PythonDevice> plug(std::vector<std::string> options = {}) {
  return patriot().plug(std::move(options));
}

TrackerKind patriot_of_one_station() {
  return {"liberty", NENDO_LIBERTY_DEVICE, 50, {"--stations", "1"}};
}

/// What arrived at a station.
struct Heard {
  std::vector<PoseSample> samples;
  StreamStats stats;
  TrackerInfo info;
};

Heard stream(const std::string& spec, std::chrono::milliseconds time) {
  OneStation hand(spec);
  test::require_ok(hand.start());
  std::this_thread::sleep_for(time);
  hand.tracker().stop();
  Heard heard{{}, hand.tracker().stats(), hand.tracker().info()};
  hand.ring.drain([&](const PoseSample& sample) { heard.samples.push_back(sample); });
  for (const PoseSample& sample : heard.samples) {
    CHECK(number_of(sample) >= 0);
    CHECK(sample.has_device_time);
    CHECK(sample.measured <= sample.arrival);
  }
  check_tracker_conservation(heard.stats, 50);
  return heard;
}

} // namespace

TEST_SUITE("liberty_driver") {
  TEST_CASE("a PATRIOT's two stations send all at once, and both are right") {
    const auto port = plug();
    const Heard heard = stream("liberty:" + port->path() + "?station=2&baud=115200", 2000ms);
    CHECK(heard.info.model == "Polhemus PATRIOT");
    CHECK(heard.info.rate_hz == 120.0);
    CHECK(heard.info.stations == std::vector<std::uint16_t>{2});
    CHECK(fact(heard.info, "stations_plugged_in") == "1, 2");
    CHECK(fact(heard.info, "identification").find("PATRIOT Polhemus emulated") !=
          std::string::npos);
    CHECK(fact(heard.info, "distortion_raw") == "0");
    CHECK(heard.samples.size() > 90);
    CHECK(heard.stats.records >= 2 * heard.samples.size());
    CHECK(heard.stats.missed == 0);
    CHECK(heard.stats.counts_missed);
    CHECK(heard.stats.bad_records == 0);
    const std::string commands = port->ask("heard");
    for (const char* command :
         {"O*,8,9,11,3,7,1", "H*,1.0000,0.0000,0.0000", "U1", "X0,1,0,0", "Y0,1,0,0", "Q0", "F1"})
      CHECK_MESSAGE(commands.find(command) != std::string::npos, command);
  }

  TEST_CASE("frames that a LIBERTY skips are missed, and its time stamps give the times") {
    const auto port = plug({"--stations", "1", "--skip", "10", "--whole"});
    const Heard heard = stream("liberty:" + port->path(), 3000ms);
    REQUIRE(heard.samples.size() > 100);
    // Of ten frames one is skipped.
    const double missed = static_cast<double>(heard.stats.missed);
    CHECK(missed == doctest::Approx(static_cast<double>(heard.samples.size()) / 9.0).epsilon(0.1));
    for (std::size_t k = 60; k < heard.samples.size(); ++k) {
      const PoseSample& last = heard.samples[k - 1];
      const PoseSample& sample = heard.samples[k];
      const double off_ms = to_milliseconds((sample.measured - last.measured) -
                                            (sample.device_time - last.device_time));
      CHECK(std::abs(off_ms) < 3.0);
    }
  }

  TEST_CASE("a LIBERTY's records are shortened or refused for the sake of its line") {
    const auto one = plug({"--model", "LY", "--stations", "1"});
    const Heard heard = stream("liberty:" + one->path(), 500ms);
    CHECK(heard.info.model == "Polhemus LIBERTY");
    CHECK(heard.info.rate_hz == 240.0);
    CHECK(fact(heard.info, "distortion_raw").empty());
    CHECK(heard.samples.size() > 60);
    const auto two = plug({"--model", "LY", "--stations", "2"});
    check_no_tracker("liberty:" + two->path(),
                     "carries 11520 bytes per second, and 480 records per second of 46 bytes need "
                     "22080");
    const auto slow = plug({"--baud", "9600"});
    check_no_tracker("liberty:" + slow->path(), "carries 960 bytes per second");
  }

  TEST_CASE("distortion and error letters of a LIBERTY arrive with its poses") {
    for (const auto& [option, value, letter] :
         {std::tuple("--distortion", "250", '!'), std::tuple("--error", "x", 'x')}) {
      const auto port = plug({option, value});
      const Heard heard = stream("liberty:" + port->path(), 200ms);
      REQUIRE_FALSE(heard.samples.empty());
      CHECK(heard.samples.front().error == letter);
    }
  }

  TEST_CASE("a LIBERTY that streams, or waits for the rest of a command, is found at any rate") {
    for (const char* odd : {"streaming", "waiting"}) {
      const auto port = plug({"--odd", odd, "--baud", "57600", "--stations", "1"});
      CHECK(stream("liberty:" + port->path(), 500ms).samples.size() > 10);
    }
  }

  TEST_CASE("a LIBERTY without the station or the items is an error that says so") {
    const auto port = plug();
    check_no_tracker("liberty:" + port->path() + "?station=3", "station 3; plugged in: 1, 2");
    const auto old = plug({"--odd", "old"});
    check_no_tracker("liberty:" + old->path(), "does not send the records");
  }

  TEST_CASE("a LIBERTY's options that are none are usage errors that name what there is") {
    wrong_tracker_options_are_usage_errors("liberty", {{"?rate=9", "baud"},
                                                       {"?baud=4800", "115200, 57600"},
                                                       {"?station=17", "station"},
                                                       {"?hemisphere=1,0", "three numbers"},
                                                       {"?filter=maybe", "off, on"}});
  }

  TEST_CASE("what is no LIBERTY is an error that says so") {
    no_tracker_is_an_error_that_says_so(patriot());
  }
  TEST_CASE("a PATRIOT's poses are in order and add up") {
    poses_are_in_order_and_add_up(patriot_of_one_station());
  }
  TEST_CASE("a full ring refuses a PATRIOT's poses and they are counted") {
    a_full_ring_refuses_poses_and_counts(patriot_of_one_station());
  }
  TEST_CASE("a PATRIOT stops promptly and starts again") {
    a_tracker_stops_promptly_and_starts_again(patriot());
  }
  TEST_CASE("a PATRIOT that falls silent is started again") {
    a_silent_tracker_is_started_again(patriot_of_one_station());
  }
  TEST_CASE("a PATRIOT stops promptly while it is silent or away") {
    a_tracker_stops_promptly_while_silent_or_away(patriot());
  }
  TEST_CASE("a PATRIOT that vanishes is found again and set up") {
    a_tracker_that_vanishes_is_found_again(patriot());
  }
}

} // namespace liberty_driver_test
