#include "simulated/wrist_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <doctest/doctest.h>

namespace wrist_motion_test {

using namespace nendo;
using namespace nendo::driver;

namespace {

constexpr std::array motions{WristMotion::rest, WristMotion::orbit, WristMotion::walk,
                             WristMotion::table, WristMotion::cross};

double distance_m(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Returns R v, with the rotation matrix of the quaternion as textbooks have it.
std::array<double, 3> turned(const std::array<double, 4>& q, const std::array<double, 3>& v) {
  const auto [x, y, z, w] = q;
  return {
      (1 - 2 * (y * y + z * z)) * v[0] + 2 * (x * y - z * w) * v[1] + 2 * (x * z + y * w) * v[2],
      2 * (x * y + z * w) * v[0] + (1 - 2 * (x * x + z * z)) * v[1] + 2 * (y * z - x * w) * v[2],
      2 * (x * z - y * w) * v[0] + 2 * (y * z + x * w) * v[1] + (1 - 2 * (x * x + y * y)) * v[2]};
}

std::array<double, 3> wrist_m(const ReceiverPose& pose) {
  const auto offset = turned(pose.turn_xyzw, receiver_to_wrist_m);
  return {pose.position_m[0] + offset[0], pose.position_m[1] + offset[1],
          pose.position_m[2] + offset[2]};
}

} // namespace

TEST_SUITE("wrist_motion") {
  TEST_CASE("each motion of a wrist is continuous, and its turns are unit quaternions") {
    for (const WristMotion motion : motions) {
      for (const std::uint16_t station : {std::uint16_t{1}, std::uint16_t{2}}) {
        CAPTURE(static_cast<int>(motion));
        ReceiverPose last = receiver_pose(motion, station, 7, 0.0);
        double max_step_m = 0.0;
        double max_step = 0.0;
        double max_norm_off = 0.0;
        for (int k = 1; k <= 20'000; ++k) {
          const ReceiverPose pose = receiver_pose(motion, station, 7, 0.001 * k);
          max_step_m = std::max(max_step_m, distance_m(pose.position_m, last.position_m));
          double squares = 0.0;
          double dot = 0.0;
          for (std::size_t c = 0; c < 4; ++c) {
            squares += pose.turn_xyzw[c] * pose.turn_xyzw[c];
            dot += pose.turn_xyzw[c] * last.turn_xyzw[c];
          }
          max_norm_off = std::max(max_norm_off, std::abs(squares - 1.0));
          max_step = std::max(max_step, 1.0 - std::abs(dot));
          last = pose;
        }
        CHECK(max_step_m < 0.001); // 1 m/s
        CHECK(max_step < 1e-5);    // 9 mrad per ms
        CHECK(max_norm_off < 1e-9);
      }
    }
  }

  TEST_CASE("in the exercise on the table the wrist's centre stays where it is") {
    const auto centre = wrist_m(receiver_pose(WristMotion::table, 1, 1, 0.0));
    double travel_m = 0.0;
    ReceiverPose last = receiver_pose(WristMotion::table, 1, 1, 0.0);
    for (int k = 1; k <= 1000; ++k) {
      const ReceiverPose pose = receiver_pose(WristMotion::table, 1, 1, 0.01 * k);
      CHECK(distance_m(wrist_m(pose), centre) < 1e-12);
      travel_m += distance_m(pose.position_m, last.position_m);
      last = pose;
    }
    CHECK(travel_m > 0.5); // the receiver moves
  }

  TEST_CASE("orbit and cross begin from rest, and cross passes the transmitter's plane") {
    for (const WristMotion motion : {WristMotion::orbit, WristMotion::walk, WristMotion::cross}) {
      const auto first = receiver_pose(motion, 1, 1, 0.0);
      CHECK(distance_m(receiver_pose(motion, 1, 1, 0.001).position_m, first.position_m) < 1e-6);
    }
    int crossings = 0;
    double last_x = receiver_pose(WristMotion::cross, 1, 1, 0.0).position_m[0];
    for (int k = 1; k <= 1000; ++k) {
      const double x = receiver_pose(WristMotion::cross, 1, 1, 0.01 * k).position_m[0];
      crossings += last_x * x < 0.0 ? 1 : 0;
      last_x = x;
    }
    CHECK(crossings >= 4);
  }

  TEST_CASE("stations of a motion are apart, and motions have names") {
    for (const WristMotion motion : motions)
      CHECK(distance_m(receiver_pose(motion, 1, 1, 3.0).position_m,
                       receiver_pose(motion, 2, 1, 3.0).position_m) > 0.2);
    for (const std::string_view name : wrist_motion_names())
      CHECK(find_wrist_motion(name));
    const auto unknown = find_wrist_motion("dance");
    REQUIRE_FALSE(unknown);
    CHECK(unknown.error().code == Errc::usage);
    CHECK(unknown.error().message.find("rest, orbit, walk, table, cross") != std::string::npos);
  }
}

} // namespace wrist_motion_test
