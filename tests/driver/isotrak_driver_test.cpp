#include <nendo/driver/open_tracker.hpp>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/numbered_poses.hpp"
#include "support/tracker_laws.hpp"

namespace isotrak_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;

namespace {

TrackerKind isotrak() {
  return {"isotrak", NENDO_ISOTRAK_DEVICE, 20};
}

// Half a step of the format is 1.6632 m / 32767 / 2 = 25.4 um, and 15.3e-6 in a quaternion. The
// latter's norm is then off by twice as much at most, for which the driver corrects.
int number_in(const PoseSample& sample) {
  return number_within({26e-6, 50e-6}, sample);
}
constexpr SharedRate shared_rate{60.0, 20, number_in};

NumberedPoses stream(const std::vector<std::string>& specs, std::chrono::seconds seconds) {
  const NumberedPoses heard = stream_numbered(specs, seconds, shared_rate);
  CHECK(heard.records == heard.count);
  return heard;
}

} // namespace

TEST_SUITE("isotrak_driver") {
  TEST_CASE("one or two ISOTRAK stations share 60 poses per second, and none is lost or wrong") {
    stations_share_the_rate(isotrak(), shared_rate, {{1}, {2, 1}, {2}});
  }

  TEST_CASE("an ISOTRAK reports who it is, and the station that is not wanted is off") {
    const auto port = isotrak().plug();
    auto stations = required(open_trackers(isotrak().specs(port->path(), {2})));
    const TrackerInfo& info = stations[0].tracker->info();
    CHECK(info.model == "Polhemus ISOTRAK II");
    CHECK(info.stations == std::vector<std::uint16_t>{2});
    CHECK(info.rate_hz == 60.0);
    CHECK(info.stage_from_tracker_xyzw == stage_from_z_down_xyzw);
    CHECK_FALSE(info.is_filtered);
    CHECK(fact(info, "status") == "21S3F0    1.10 ISO");
    CHECK(fact(info, "stations_plugged_in") == "1, 2");
    CHECK(fact(info, "baud") == "115200");
    CHECK(fact(info, "filter") == "off");
    CHECK(fact(info, "refused_commands").empty());
    CHECK(port->ask("counts").find("forbidden 0 on 2") != std::string::npos);
    const std::string heard = port->ask("heard");
    for (const char* command :
         {"O2,11", "R2", "b2", "H2,1.0000,0.0000,0.0000", " u ", "x0,1,0,0", "v0,1,0,0", "l1,0"})
      CHECK_MESSAGE(heard.find(command) != std::string::npos, command);
    stations.clear();
    // Both again, after a run that had switched one off.
    stations = required(open_trackers(isotrak().specs(port->path(), {1, 2})));
    CHECK(stations[0].tracker == stations[1].tracker);
    CHECK(port->ask("counts").find("on 12") != std::string::npos);
  }

  TEST_CASE("the options of an ISOTRAK reach it") {
    const auto port = isotrak().plug();
    const auto heard =
        stream(isotrak().specs(port->path(), {1}, "&baud=115200&hemisphere=0,0,-1&filter=on"), 1s);
    CHECK(heard.wrong == 0);
    const std::string commands = port->ask("heard");
    CHECK(commands.find("H1,0.0000,0.0000,-1.0000") != std::string::npos);
    CHECK(commands.find("x0.2,0.2,0.8,0.8") != std::string::npos);
    CHECK(required(open_trackers(isotrak().specs(port->path(), {1}, "&filter=on")))
              .front()
              .tracker->info()
              .is_filtered);
    // In the other half space it reports the opposite position.
    const auto turned = stream(isotrak().specs(port->path(), {1}, "&hemisphere=0,0,1"), 1s);
    CHECK(turned.wrong == turned.count);
  }

  TEST_CASE("an ISOTRAK is found at each rate of its line, and one that is too slow is refused") {
    for (const char* rate : {"115200", "57600", "38400", "19200"}) {
      const std::string baud = rate;
      CAPTURE(baud);
      const auto port = isotrak().plug({"--baud", baud});
      const std::string spec = isotrak().specs(port->path(), {1}).front();
      CHECK(fact(required(open_trackers(std::vector{spec})).front().tracker->info(), "baud") ==
            baud);
      CHECK(stream({spec + "&baud=" + baud}, 1s).wrong == 0);
    }
    const auto port = isotrak().plug({"--baud", "9600"});
    check_no_tracker("isotrak:" + port->path(),
                     "a line of 9600 baud carries 960 bytes per second, and 60 records per second "
                     "of 20 bytes need 1200; set the tracker's line to 19200");
  }

  TEST_CASE("an ISOTRAK at another rate than baud= is not found, and the error says so") {
    const auto port = isotrak().plug({"--baud", "57600"});
    check_no_tracker("isotrak:" + port->path() + "?baud=115200", "baud rate of 115200");
  }

  TEST_CASE("an ISOTRAK that streams, or waits for the rest of a command, is found at any rate") {
    for (const char* odd : {"streaming", "waiting"}) {
      for (const char* baud : {"115200", "57600"}) {
        CAPTURE(odd);
        CAPTURE(baud);
        const auto port = isotrak().plug({"--odd", odd, "--baud", baud});
        CHECK(stream(isotrak().specs(port->path(), {1}), 1s).wrong == 0);
        CHECK(port->ask("counts").find("forbidden 0") != std::string::npos);
      }
    }
  }

  TEST_CASE("a station of an ISOTRAK without a receiver is an error that names the other") {
    const auto one = isotrak().plug({"--plugged", "1"});
    check_no_tracker("isotrak:" + one->path() + "?station=2",
                     "no receiver is plugged in at station 2; plugged in: 1");
    CHECK(stream(isotrak().specs(one->path(), {1}), 1s).wrong == 0);
    const auto none = isotrak().plug({"--plugged", ""});
    check_no_tracker("isotrak:" + none->path(), "is a receiver plugged in");
  }

  TEST_CASE("an ISOTRAK without quaternions is an error, and without filters it is used") {
    const auto old = isotrak().plug({"--odd", "old"});
    check_no_tracker("isotrak:" + old->path(), "does not send the records");
    const auto refusing = isotrak().plug({"--odd", "refuse"});
    const auto station = required(open_trackers(isotrak().specs(refusing->path(), {1}))).front();
    CHECK(fact(station.tracker->info(), "refused_commands") ==
          "x0,1,0,0 (error -99), v0,1,0,0 (error -99)");
  }

  TEST_CASE("an error letter of an ISOTRAK arrives with its pose, and a button is none") {
    for (const auto& [third, error] :
         {std::pair("*", ' '), std::pair("@", ' '), std::pair(" ", ' '), std::pair("C", 'C')}) {
      const auto port = isotrak().plug({"--third", third});
      OneStation hand("isotrak:" + port->path());
      test::require_ok(hand.start());
      PoseSample sample;
      REQUIRE(eventually([&] { return hand.ring.try_pop(sample); }));
      hand.tracker().stop();
      CHECK(sample.error == error);
      CHECK(number_in(sample) >= 0);
    }
  }

  TEST_CASE("the time of an ISOTRAK's pose excludes line and the records that came with it") {
    // 20 bytes of 10 bits at 115200 baud are 1.736 ms.
    times_exclude_what_delays(isotrak(), {1.736, 16.667});
  }

  TEST_CASE("a FASTRAK is no ISOTRAK, nor is an ISOTRAK a FASTRAK") {
    const PythonDevice fastrak(NENDO_FASTRAK_DEVICE);
    check_no_tracker("isotrak:" + fastrak.path(), "what is there is no ISOTRAK II");
    const auto port = isotrak().plug();
    check_no_tracker("fastrak:" + port->path(), "what is there is no FASTRAK");
  }

  TEST_CASE("an ISOTRAK's options that are none are usage errors that name what there is") {
    wrong_tracker_options_are_usage_errors("isotrak",
                                           {{"?rate=9", "baud"},
                                            {"?baud=4800", "115200, 57600"},
                                            {"?baud=9600", "carries 960 bytes per second"},
                                            {"?station=0", "station"},
                                            {"?station=3", "station must be 1 or 2"},
                                            {"?hemisphere=1,0", "three numbers"},
                                            {"?filter=maybe", "off, on"}});
  }

  TEST_CASE("what is no ISOTRAK is an error that says so") {
    no_tracker_is_an_error_that_says_so(isotrak());
  }
  TEST_CASE("an ISOTRAK's poses are in order and add up") {
    poses_are_in_order_and_add_up(isotrak());
  }
  TEST_CASE("a full ring refuses an ISOTRAK's poses and they are counted") {
    a_full_ring_refuses_poses_and_counts(isotrak());
  }
  TEST_CASE("an ISOTRAK stops promptly and starts again") {
    a_tracker_stops_promptly_and_starts_again(isotrak());
  }
  TEST_CASE("an ISOTRAK that falls silent is started again") {
    a_silent_tracker_is_started_again(isotrak());
  }
  TEST_CASE("an ISOTRAK stops promptly while it is silent or away") {
    a_tracker_stops_promptly_while_silent_or_away(isotrak());
  }
  TEST_CASE("an ISOTRAK that vanishes is found again and set up") {
    a_tracker_that_vanishes_is_found_again(isotrak());
  }
}

} // namespace isotrak_driver_test
