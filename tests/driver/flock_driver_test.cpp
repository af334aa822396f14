#include <nendo/driver/open_tracker.hpp>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/numbered_poses.hpp"
#include "support/pty_unit.hpp"
#include "support/tracker_laws.hpp"
#include "units/flock_unit.hpp"

namespace flock_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;

namespace {

TrackerKind flock() {
  return {"flock", NENDO_FLOCK_DEVICE, 15};
}

TrackerKind birds(const std::string& addresses) {
  return {"flock", NENDO_FLOCK_DEVICE, 15, {"--birds", addresses}};
}

/// Returns the number of a record of the Python device, or -1 if it is not the one that was sent.
template <int range_in = 36>
int number_of(const PoseSample& sample) {
  constexpr double step_m = range_in * 0.0254 / 8192.0;
  const double number = sample.position_m[0] / step_m - 1000.0;
  const double half_rad = std::round(number) / 1000.0;
  constexpr double turn_step = 1.0 / 8192.0;
  const bool good = std::abs(number - std::round(number)) < 0.01 &&
                    std::abs(sample.position_m[1] / step_m - 200.0 * sample.station) < 0.01 &&
                    std::abs(sample.position_m[2] / step_m + 700.0) < 0.01 &&
                    std::abs(sample.turn_xyzw[2] - std::sin(half_rad)) < turn_step &&
                    // The positive full scale wraps, and means the same turn.
                    std::abs(std::abs(sample.turn_xyzw[3]) - std::cos(half_rad)) < turn_step &&
                    sample.turn_xyzw[0] == 0.0 && sample.turn_xyzw[1] == 0.0;
  return good ? static_cast<int>(std::round(number)) : -1;
}

/// Each of so many birds measures by itself.
template <int range_in = 36>
SharedRate rate_of(std::size_t count) {
  return {103.3 * static_cast<double>(count), 15, number_of<range_in>};
}

template <int range_in = 36>
NumberedPoses stream(const std::vector<std::string>& specs, std::chrono::milliseconds time) {
  return stream_numbered(specs, time, rate_of<range_in>(specs.size()));
}

} // namespace

TEST_SUITE("flock_driver") {
  TEST_CASE("each of one to four birds sends its own 103.3 poses per second, none lost or wrong") {
    for (const std::vector<int>& stations :
         {std::vector{1}, std::vector{2, 1}, std::vector{1, 2, 3, 4}})
      stations_share_the_rate(birds(std::string("1234").substr(0, stations.size())),
                              rate_of(stations.size()), {stations});
  }

  TEST_CASE("a Flock reports who it is, and all of its birds are set up") {
    const auto port = flock().plug({"--birds", "134", "--error", "32"});
    const auto stations =
        required(open_trackers(flock().specs(port->path(), {4, 1}, "&hemisphere=upper")));
    CHECK(stations[0].tracker == stations[1].tracker);
    const TrackerInfo& info = stations[0].tracker->info();
    CHECK(info.model == "Ascension Flock of Birds, 3 birds");
    CHECK(info.stations == std::vector<std::uint16_t>{4, 1});
    CHECK(info.rate_hz == doctest::Approx(3 * 103.3).epsilon(0.001));
    CHECK(info.stage_from_tracker_xyzw == stage_from_z_down_xyzw);
    CHECK_FALSE(info.is_filtered);
    CHECK(fact(info, "identification") == "6DFOB");
    CHECK(fact(info, "firmware") == "3.60");
    CHECK(fact(info, "birds") == "1, 3, 4");
    CHECK(fact(info, "baud") == "115200");
    CHECK(fact(info, "error").find("receiver saturated") == 0);
    const std::string heard = port->ask("heard");
    for (const char* command :
         {"1P.50.4", "1P.35.1", "1]", "3]", "4]", "1L.12.1", "3L.12.1", "4L.12.1"})
      CHECK_MESSAGE(heard.find(command) != std::string::npos, command);
  }

  TEST_CASE("a Flock that slept is woken, and not configured again") {
    const auto port = flock().plug();
    CHECK(stream(flock().specs(port->path(), {1}), 300ms).wrong == 0);
    CHECK(stream(flock().specs(port->path(), {2}), 300ms).wrong == 0);
    std::string heard;
    CHECK(eventually([&] {
      heard = port->ask("heard");
      return heard.substr(heard.size() - 5) == "1B 1G";
    }));
    CHECK(heard.find("P.50", heard.find("P.50") + 1) == std::string::npos);
  }

  TEST_CASE("the range of positions is that of scale and controller") {
    const auto wide = flock().plug({"--scale", "1"});
    CHECK(stream<72>(flock().specs(wide->path(), {1}), 300ms).wrong == 0);
    const auto far = flock().plug({"--birds", "23", "--odd", "erc"});
    CHECK(stream<144>(flock().specs(far->path(), {2, 3}), 300ms).wrong == 0);
    check_no_tracker("flock:" + far->path(), "unit 1 has no receiver; units with one: 2, 3");
  }

  TEST_CASE("in the other hemisphere a bird reports the opposite position") {
    const auto port = flock().plug();
    CHECK(stream(flock().specs(port->path(), {1}, "&hemisphere=upper"), 300ms).wrong == 0);
    const NumberedPoses turned =
        stream(flock().specs(port->path(), {1}, "&hemisphere=lower"), 300ms);
    CHECK(turned.wrong == turned.count);
  }

  TEST_CASE("a Flock is found at each rate of its line, and one that is too slow is refused") {
    for (const char* baud : {"115200", "57600", "38400", "19200"}) {
      CAPTURE(baud);
      const auto port = flock().plug({"--baud", baud, "--birds", "1"});
      CHECK(stream(flock().specs(port->path(), {1}), 300ms).wrong == 0);
      CHECK(stream(flock().specs(port->path(), {1}, std::string("&baud=") + baud), 300ms).wrong ==
            0);
    }
    const auto slow = flock().plug({"--baud", "9600", "--birds", "1"});
    for (const char* option : {"", "?baud=9600"}) {
      const auto refused = open_trackers(std::vector{"flock:" + slow->path() + option});
      REQUIRE_FALSE(refused);
      CAPTURE(refused.error().message);
      CHECK(refused.error().code == Errc::usage);
      CHECK(refused.error().message.find("need 1550 bytes per second, and 9600 baud carries 960") !=
            std::string::npos);
    }
    check_no_tracker("flock:" + slow->path() + "?baud=38400", "at 38400");
  }

  TEST_CASE("a Flock that streams already, or that a reset keeps deaf for 2 s, is found") {
    for (const char* odd : {"streaming", "deaf"}) {
      for (const char* baud : {"115200", "38400"}) {
        CAPTURE(odd);
        const auto port = flock().plug({"--odd", odd, "--baud", baud});
        CHECK(stream(flock().specs(port->path(), {1, 2}), 300ms).wrong == 0);
      }
    }
  }

  TEST_CASE("units that do not run are an error that names their switches") {
    const auto port = flock().plug({"--odd", "standby"});
    check_no_tracker("flock:" + port->path(), "fly");
  }

  TEST_CASE("the birds of a cycle are measured together, when its first byte was sent") {
    const auto port = flock().plug({"--burst", "3"});
    const auto stations = required(open_trackers(flock().specs(port->path(), {1, 2})));
    PoseRing one(4096);
    PoseRing two(4096);
    PoseRing* const rings[]{&one, &two};
    test::require_ok(start_trackers(stations, rings));
    REQUIRE(eventually([&] { return two.size() >= 30; }));
    stations.front().tracker->stop();
    int together = 0;
    PoseSample first;
    PoseSample second;
    while (one.try_pop(first) && two.try_pop(second)) {
      CHECK(number_of<>(first) == number_of<>(second));
      if (first.arrival != second.arrival) continue; // the chunk was cut within the cycle
      ++together;
      CHECK(first.measured == second.measured);
      CHECK(to_milliseconds(first.arrival - first.measured) > 2.6); // 30 bytes of 10 bits
      CHECK(to_milliseconds(first.arrival - first.measured) < 2.61 + 2 * 9.69);
    }
    CHECK(together > 20);
  }

  TEST_CASE("the driver and the emulated unit agree about poses") {
    emulator::flock::FlockUnitOptions options;
    options.birds = {1, 2};
    PtyUnit port(std::make_unique<emulator::flock::FlockUnit>(options));
    OneStation hand("flock:" + port.path() + "?station=2");
    test::require_ok(hand.start());
    REQUIRE(eventually([&] { return hand.ring.size() >= 50; }));
    hand.tracker().stop();
    const StreamStats stats = hand.tracker().stats();
    CHECK(stats.bad_records == 0);
    std::array<double, 3> last{};
    hand.ring.drain([&](const PoseSample& sample) {
      // The receiver's x axis points along the circle that it walks, so its distance from the
      // circle's centre stays: see wrist_motion.hpp.
      const auto [x, y, z, w] = sample.turn_xyzw;
      CHECK(x == doctest::Approx(0.0).epsilon(0.001));
      CHECK(y == doctest::Approx(0.0).epsilon(0.001));
      const double angle = 2.0 * std::atan2(z, w);
      const double wrist_x = sample.position_m[0] + 0.06 * std::cos(angle);
      const double wrist_y = sample.position_m[1] + 0.06 * std::sin(angle);
      CHECK(wrist_x == doctest::Approx(0.5 - 0.3 * std::sin(angle)).epsilon(0.001));
      CHECK(wrist_y == doctest::Approx(0.3 * std::cos(angle)).epsilon(0.001));
      CHECK(sample.position_m[2] == doctest::Approx(-0.125).epsilon(0.001));
      last = sample.position_m;
    });
    CHECK(last[0] != 0.0);
  }

  TEST_CASE("a Flock's options that are none are usage errors that name what there is") {
    wrong_tracker_options_are_usage_errors("flock", {{"?rate=9", "baud"},
                                                     {"?baud=4800", "115200, 57600"},
                                                     {"?station=0", "station"},
                                                     {"?station=15", "1 to 14"},
                                                     {"?hemisphere=1,0,0", "forward, aft"}});
  }

  TEST_CASE("what is no Flock is an error that says so") {
    no_tracker_is_an_error_that_says_so(flock());
  }
  TEST_CASE("a Flock's poses are in order and add up") {
    poses_are_in_order_and_add_up(birds("1"));
  }
  TEST_CASE("a full ring refuses a Flock's poses and they are counted") {
    a_full_ring_refuses_poses_and_counts(birds("1"));
  }
  TEST_CASE("a Flock stops promptly and starts again") {
    a_tracker_stops_promptly_and_starts_again(flock());
  }
  TEST_CASE("a Flock that falls silent is started again") {
    a_silent_tracker_is_started_again(birds("1"));
  }
  TEST_CASE("a Flock stops promptly while it is silent or away") {
    a_tracker_stops_promptly_while_silent_or_away(flock());
  }
  TEST_CASE("a Flock that vanishes is found again and set up") {
    a_tracker_that_vanishes_is_found_again(flock());
  }
}

} // namespace flock_driver_test
