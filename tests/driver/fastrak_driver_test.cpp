#include <nendo/driver/open_tracker.hpp>

#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/numbered_poses.hpp"
#include "support/tracker_laws.hpp"

namespace fastrak_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;

namespace {

TrackerKind fastrak() {
  return {"fastrak", NENDO_FASTRAK_DEVICE, 33};
}

constexpr SharedRate shared_rate{120.0, 33};

NumberedPoses stream(const std::vector<std::string>& specs, std::chrono::seconds seconds) {
  const NumberedPoses heard = stream_numbered(specs, seconds, shared_rate);
  CHECK(heard.records == heard.count);
  return heard;
}

} // namespace

TEST_SUITE("fastrak_driver") {
  TEST_CASE("one to four FASTRAK stations share 120 poses per second, and none is lost or wrong") {
    stations_share_the_rate(fastrak(), shared_rate, {{1}, {2, 1}, {1, 3, 4}, {1, 2, 3, 4}});
  }

  TEST_CASE("a FASTRAK reports who it is, and its stations are switched on, the others off") {
    const auto port = fastrak().plug({"--plugged", "134"});
    auto stations = required(open_trackers(fastrak().specs(port->path(), {4, 1})));
    CHECK(stations[0].tracker == stations[1].tracker);
    CHECK(stations[0].station == 4);
    const TrackerInfo& info = stations[0].tracker->info();
    CHECK(info.model == "Polhemus FASTRAK");
    CHECK(info.stations == std::vector<std::uint16_t>{4, 1});
    CHECK(info.rate_hz == 120.0);
    CHECK(info.stage_from_tracker_xyzw == stage_from_z_down_xyzw);
    CHECK_FALSE(info.is_filtered);
    CHECK(fact(info, "firmware") == "02.03");
    CHECK(fact(info, "identification") == "FASTRAK emulated in Python");
    CHECK(fact(info, "stations_plugged_in") == "1, 3, 4");
    CHECK(fact(info, "error") == "none");
    CHECK(fact(info, "baud") == "115200");
    CHECK(port->ask("counts") == "sent 0 forbidden 0 on 14");
    const std::string heard = port->ask("heard");
    for (const char* command : {"O1,2,11,1", "I4,0", "H4,1.0000,0.0000,0.0000", "e1,0", " u ",
                                "x0,1,0,0", "v0,1,0,0", "l3,0"})
      CHECK_MESSAGE(heard.find(command) != std::string::npos, command);
    stations.clear();
    // A station again, after a run that had switched it off.
    CHECK(required(open_trackers(fastrak().specs(port->path(), {3}))).front().station == 3);
    CHECK(port->ask("counts") == "sent 0 forbidden 0 on 3");
  }

  TEST_CASE("the options of a FASTRAK reach it") {
    const auto port = fastrak().plug();
    const auto heard =
        stream(fastrak().specs(port->path(), {1}, "&baud=115200&hemisphere=0,0,-1&filter=on"), 1s);
    CHECK(heard.wrong == 0);
    const std::string commands = port->ask("heard");
    CHECK(commands.find("H1,0.0000,0.0000,-1.0000") != std::string::npos);
    CHECK(commands.find("x0.2,0.2,0.8,0.8") != std::string::npos);
    CHECK(required(open_trackers(fastrak().specs(port->path(), {1}, "&filter=on")))
              .front()
              .tracker->info()
              .is_filtered);
    // In the other half space it reports the opposite position.
    const auto turned = stream(fastrak().specs(port->path(), {1}, "&hemisphere=0,0,1"), 1s);
    CHECK(turned.wrong == turned.count);
  }

  TEST_CASE("a FASTRAK is found at each rate of its line, and one that is too slow is refused") {
    for (const auto& [rate, bytes] :
         {std::pair("115200", ""), std::pair("57600", ""), std::pair("38400", "3840"),
          std::pair("19200", "1920"), std::pair("9600", "960")}) {
      const std::string baud = rate; // doctest captures no structured binding
      CAPTURE(baud);
      const auto port = fastrak().plug({"--baud", baud});
      const std::string spec = fastrak().specs(port->path(), {1}).front();
      const std::string set = spec + "&baud=" + baud;
      const auto begin = HostClock::now();
      if (std::string_view(bytes).empty()) {
        CHECK(fact(required(open_trackers(std::vector{spec})).front().tracker->info(), "baud") ==
              baud);
        MESSAGE("found at ", std::string(baud), " baud after ",
                to_seconds(HostClock::now() - begin), " s");
        CHECK(stream({set}, 1s).wrong == 0);
        continue;
      }
      check_no_tracker(spec, std::string("carries ") + bytes + " bytes per second");
      MESSAGE("refused at ", std::string(baud), " baud after ",
              to_seconds(HostClock::now() - begin), " s");
      const auto refused = open_trackers(std::vector{set});
      REQUIRE_FALSE(refused);
      CHECK(refused.error().code == Errc::usage);
      CHECK(refused.error().message.find("need 3960") != std::string::npos);
    }
  }

  TEST_CASE("a FASTRAK at another rate than baud= is not found, and the error says so") {
    const auto port = fastrak().plug({"--baud", "57600"});
    check_no_tracker("fastrak:" + port->path() + "?baud=115200", "baud rate of 115200");
  }

  TEST_CASE("a FASTRAK that streams, or waits for the rest of a command, is found at any rate") {
    for (const char* odd : {"streaming", "waiting"}) {
      for (const char* baud : {"115200", "57600"}) {
        CAPTURE(odd);
        CAPTURE(baud);
        const auto port = fastrak().plug({"--odd", odd, "--baud", baud});
        CHECK(stream(fastrak().specs(port->path(), {1}), 1s).wrong == 0);
        CHECK(port->ask("counts").find("forbidden 0") != std::string::npos);
      }
    }
  }

  TEST_CASE("a station without a receiver is an error that lists the others") {
    const auto port = fastrak().plug({"--plugged", "13"});
    const auto none = open_trackers(fastrak().specs(port->path(), {1, 2}));
    REQUIRE_FALSE(none);
    CHECK(none.error().code == Errc::no_device);
    CHECK(none.error().message.find("station 2; plugged in: 1, 3") != std::string::npos);
    const auto beyond = open_trackers(fastrak().specs(port->path(), {5}));
    REQUIRE_FALSE(beyond);
    CHECK(beyond.error().code == Errc::usage);
    CHECK(beyond.error().message.find("1 to 4") != std::string::npos);
  }

  TEST_CASE("a FASTRAK that refuses centimetres or a question is an error, without filters it is "
            "used") {
    const auto inches = fastrak().plug({"--odd", "inches"});
    check_no_tracker("fastrak:" + inches->path(), "centimetres");
    const auto deaf = fastrak().plug({"--odd", "deaf"});
    check_no_tracker("fastrak:" + deaf->path(), "later not l");
    const auto refusing = fastrak().plug({"--odd", "refuse"});
    const auto station = required(open_trackers(fastrak().specs(refusing->path(), {1}))).front();
    CHECK(fact(station.tracker->info(), "refused_commands") ==
          "x0,1,0,0 (error -99), v0,1,0,0 (error -99)");
  }

  TEST_CASE("an InterSense tracker is used as a FASTRAK of unknown rate") {
    const auto port = fastrak().plug({"--status", "54"});
    auto stations = required(open_trackers(fastrak().specs(port->path(), {2})));
    CHECK(stations[0].tracker->info().model == "InterSense, as FASTRAK");
    CHECK(stations[0].tracker->info().rate_hz == 0.0);
    stations.clear();
    CHECK(stream(fastrak().specs(port->path(), {2}), 1s).wrong == 0);
  }

  TEST_CASE("an error letter arrives with its pose") {
    const auto port = fastrak().plug({"--error", "k"});
    OneStation hand("fastrak:" + port->path());
    test::require_ok(hand.start());
    PoseSample sample;
    REQUIRE(eventually([&] { return hand.ring.try_pop(sample); }));
    hand.tracker().stop();
    CHECK(sample.error == 'k');
    CHECK(number_of(sample) == 0);
  }

  TEST_CASE("the time of a pose excludes line, solution and the records that came with it") {
    // 33 bytes of 10 bits at 115200 baud are 2.865 ms, the solution takes 3.75 ms.
    times_exclude_what_delays(fastrak(), {6.615, 8.333});
  }

  TEST_CASE("a FASTRAK's options that are none are usage errors that name what there is") {
    wrong_tracker_options_are_usage_errors("fastrak",
                                           {{"?rate=9", "baud"},
                                            {"?baud=4800", "115200, 57600"},
                                            {"?baud=9600", "carries 960 bytes per second"},
                                            {"?station=0", "station"},
                                            {"?station=13", "station"},
                                            {"?hemisphere=1,0", "three numbers"},
                                            {"?hemisphere=1,0,0,0", "three numbers"},
                                            {"?hemisphere=1,x,0", "three numbers"},
                                            {"?hemisphere=1,0,2", "three numbers"},
                                            {"?filter=maybe", "off, on"}});
  }

  TEST_CASE("what is no FASTRAK is an error that says so") {
    no_tracker_is_an_error_that_says_so(fastrak());
  }
  TEST_CASE("a FASTRAK's poses are in order and add up") {
    poses_are_in_order_and_add_up(fastrak());
  }
  TEST_CASE("a full ring refuses a FASTRAK's poses and they are counted") {
    a_full_ring_refuses_poses_and_counts(fastrak());
  }
  TEST_CASE("a FASTRAK stops promptly and starts again") {
    a_tracker_stops_promptly_and_starts_again(fastrak());
  }
  TEST_CASE("a FASTRAK that falls silent is started again") {
    a_silent_tracker_is_started_again(fastrak());
  }
  TEST_CASE("a FASTRAK stops promptly while it is silent or away") {
    a_tracker_stops_promptly_while_silent_or_away(fastrak());
  }
  TEST_CASE("a FASTRAK that vanishes is found again and set up") {
    a_tracker_that_vanishes_is_found_again(fastrak());
  }
}

} // namespace fastrak_driver_test
