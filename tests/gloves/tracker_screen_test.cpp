#include "gloves/tracker_screen.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "gloves/open_tracker.hpp"
#include "gloves/tracker_text.hpp"
#include "gloves/wrist_notices.hpp"

namespace tracker_screen_test {

using namespace nendo;
using namespace nendo::gloves;
using namespace std::chrono_literals;

namespace {

constexpr double half_sqrt = 0.70710678118654752;

PoseSample any_pose(HostTime arrival) {
  PoseSample pose;
  pose.arrival = pose.measured = arrival;
  pose.position_m = {0.4123, -0.0005, -1.5};
  pose.turn_xyzw = {0.0, 0.0, half_sqrt, half_sqrt};
  return pose;
}

/// A picture of a tracker with two stations, of which the first has sent for a second.
struct Shown {
  driver::TrackerInfo info;
  std::array<SeenPoses, 2> seen;
  HostTime now = HostClock::now();

  Shown() {
    info.source = "fastrak:/dev/ttyUSB2";
    info.model = "Polhemus FASTRAK";
    info.rate_hz = 120.0;
    for (int pose = 0; pose <= 60; ++pose)
      seen[0].add(any_pose(now + pose * std::chrono::nanoseconds(1s) / 60));
    now += 1s + 12ms;
  }
  std::vector<std::string> lines(int columns = 80, int rows = 24) const {
    TrackerPicture picture{&info, {}, {{1, &seen[0]}, {2, &seen[1]}}};
    picture.stats.records = 61;
    picture.stats.rate_hz = 60.0;
    return tracker_lines({picture}, now, true, {columns, rows});
  }
};

bool is_printable(const std::string& line) {
  return std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

} // namespace

TEST_SUITE("tracker_screen") {
  TEST_CASE("each station has a line with its position, turn, rate, age and error") {
    const auto lines = Shown().lines();
    REQUIRE(lines.size() == 5);
    CHECK(lines[0].starts_with("fastrak:/dev/ttyUSB2: Polhemus FASTRAK"));
    CHECK(lines[1].find("only 60.0 of 120.0/s") == 0);
    CHECK(lines[1].find("12 ms old") != std::string::npos);
    CHECK(lines[1].find("losses on the line: some") != std::string::npos);
    const std::string& heading = lines[2];
    const std::string& row = lines[3];
    CHECK(row.size() == heading.size());
    const auto below = [&](const std::string& name) {
      const std::size_t end = heading.find(name) + name.size();
      return row.substr(row.rfind(' ', end - 1) + 1, end - row.rfind(' ', end - 1) - 1);
    };
    CHECK(below("station") == "1");
    CHECK(below("x mm") == "412.3");
    CHECK(below("y mm") == "-0.5");
    CHECK(below("z mm") == "-1500.0");
    CHECK(below("azimuth") == "90.0");
    CHECK(std::abs(std::stod(below("elevation"))) < 0.1);
    CHECK(below("per s") == "60.0");
    CHECK(below("age ms") == "12");
    CHECK(below("error") == "-");
    CHECK(lines[4] == "      2  no pose yet");
  }

  TEST_CASE("whatever the window and the numbers, no line is too long and none too many") {
    Shown shown;
    PoseSample wild = any_pose(shown.now);
    wild.position_m = {std::numeric_limits<double>::infinity(), -1e300, std::nan("")};
    wild.turn_xyzw = {0.0, 0.0, 0.0, 0.0};
    wild.error = '\x1b';
    shown.seen[1].add(wild);
    for (int columns = 1; columns <= 100; ++columns)
      for (const int rows : {0, 1, 3, 4, 5, 24}) {
        const auto lines = shown.lines(columns, rows);
        REQUIRE(static_cast<int>(lines.size()) <= rows);
        for (const auto& line : lines) {
          REQUIRE(static_cast<int>(line.size()) <= columns);
          REQUIRE(is_printable(line));
        }
      }
    CHECK(nlohmann::json::parse(pose_json(shown.info.source, wild))["position_m"][0].is_null());
  }

  TEST_CASE("the angles are those of trackers: about z, then y, then x") {
    const double angle = 0.5;
    const auto alone = [&](std::size_t axis) {
      std::array<double, 4> turn{0.0, 0.0, 0.0, std::cos(angle / 2)};
      turn[axis] = std::sin(angle / 2);
      return angles_of(turn);
    };
    CHECK(alone(2).azimuth_deg == doctest::Approx(to_degrees(angle)));
    CHECK(alone(1).elevation_deg == doctest::Approx(to_degrees(angle)));
    CHECK(alone(0).roll_deg == doctest::Approx(to_degrees(angle)));
    // A turn of 90 degrees about z, then of 90 about the new x: i j k as 0.5 0.5 0.5 0.5.
    const TurnAngles both = angles_of({0.5, 0.5, 0.5, 0.5});
    CHECK(both.azimuth_deg == doctest::Approx(90.0));
    CHECK(both.elevation_deg == doctest::Approx(0.0));
    CHECK(both.roll_deg == doctest::Approx(90.0));
  }

  TEST_CASE("the axes are described as the operator sees them") {
    driver::TrackerInfo info;
    CHECK(axes_text(info) == "x to the right, y up, z towards the operator");
    info.stage_from_tracker_xyzw = driver::stage_from_z_down_xyzw;
    CHECK(axes_text(info) == "x away from the operator, y to the right, z down");
    info.stage_from_tracker_xyzw = {0.0, 0.0, 0.3826834, 0.9238795};
    CHECK(axes_text(info).find("0.3827") != std::string::npos);
  }

  TEST_CASE("a device argument is a tracker by its kind, its motion, or because the user says so") {
    for (const std::string spec : {"sim:orbit", "sim:walk?station=2", "sim:cross"})
      CHECK(is_tracker(spec, false));
    for (const std::string spec :
         {"sim", "sim:rest", "sim:table", "sim:sculpt", "sim:touch", "serial:/dev/ttyUSB0", "auto",
          "replay:take.nendo", "bogus:1", "", "/dev/ttyUSB0"}) {
      CAPTURE(spec);
      CHECK_FALSE(is_tracker(spec, false));
      CHECK(is_tracker(spec, true));
    }
  }
}

TEST_SUITE("wrist_notices") {
  TEST_CASE("a long loss and its end are reported, a short one is not, and flips once") {
    WristNotices notices;
    flow::HandFrame hand;
    HostTime now{};
    const auto next = [&](bool lost, HostClock::duration later) {
      hand.lost = lost;
      now += later;
      return notices.changes(Side::left, hand, now, {});
    };
    CHECK(next(true, 10s).empty()); // no tracker
    hand.tracked = true;
    hand.pose_counts.poses = 1;
    CHECK(next(true, 1s).empty());
    CHECK(next(true, 400ms).empty());
    CHECK(next(false, 10ms).empty());
    CHECK(next(true, 1s).empty());
    const auto lost = next(true, 500ms);
    REQUIRE(lost.size() == 1);
    CHECK(lost[0] == "no good pose of the left wrist comes: the hand stays where it is");
    CHECK(next(true, 1s).empty());
    const auto back = next(false, 10ms);
    REQUIRE(back.size() == 1);
    CHECK(back[0] == "the left wrist is back");
    hand.pose_counts.flips = 3;
    const auto flips = next(false, 10ms);
    REQUIRE(flips.size() == 1);
    CHECK(flips[0].find("hemisphere=") != std::string::npos);
    hand.pose_counts.flips = 9;
    CHECK(next(false, 10s).empty());
  }

  TEST_CASE("a wrist of which no pose ever came is reported with what to check, by its tracker") {
    WristNotices notices;
    flow::HandFrame hand;
    hand.tracked = hand.lost = true;
    for (const auto& [source, said] :
         {std::pair{"fastrak:/dev/ttyUSB2?station=3", "receiver of station 3"},
          {"flock:/dev/ttyUSB2?station=3", "near the transmitter"},
          {"osc:9000/left", "to this port"},
          {"vrpn:Tracker0@host?sensor=0", "server tracks this sensor"},
          {"evdev:SpaceMouse", "plug the device in again"},
          {"serve:right", "nendo serve"},
          {"replay:take.nendo?hand=left", "recording"}}) {
      const std::string advice = no_pose_advice({nullptr, 3, source});
      CAPTURE(advice);
      CHECK(advice.find(said) != std::string::npos);
      CHECK(advice.find("interface unit") == std::string::npos);
    }
    const driver::TrackerStation station{nullptr, 2, "fastrak:/dev/ttyUSB2?station=2"};
    CHECK(notices.changes(Side::right, hand, HostTime(1s), station).empty());
    const auto lost = notices.changes(Side::right, hand, HostTime(2s), station);
    REQUIRE(lost.size() == 1);
    CHECK(lost[0] == "no pose of the right wrist comes: the hand stays where it is; " +
                         no_pose_advice(station));
  }
}

} // namespace tracker_screen_test
