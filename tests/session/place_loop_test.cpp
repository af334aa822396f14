#include "session/place_loop.hpp"

#include <string>

#include <doctest/doctest.h>

#include "session/open_hands.hpp"
#include "support/test_meshes.hpp"

namespace place_loop_test {

using namespace nendo;
using namespace nendo::gloves;
using namespace nendo::session;

TEST_SUITE("place_loop") {
  TEST_CASE("a radius is refused where it is out of range on the stage") {
    const auto mesh = test::sphere(12, 24, 1.0); // 0.8 m on the stage
    RunOptions options;
    options.right = "sim";
    EventCount event_count;
    const auto opened = open_hands(options, mesh, event_count);
    REQUIRE(opened);
    for (const char* radius : {"1e10", "1e-10", "1e-10m"}) {
      CAPTURE(radius);
      options.radius = radius;
      const auto placed = place_loop(options, opened->hands, mesh);
      REQUIRE_FALSE(placed);
      CHECK(placed.error().message ==
            "--radius " + options.radius + ": radius_m: use 1e-09 to 1e+09 m");
    }
    options.radius = "1,1,1,1,1,2,2,2,2,2";
    const auto placed = place_loop(options, opened->hands, mesh);
    REQUIRE_FALSE(placed);
    CHECK(placed.error().message.find("there is one hand") != std::string::npos);
  }

  TEST_CASE("a loop has the calibration and the size of the glove that is there now") {
    const auto mesh = test::sphere(12, 24, 1.0);
    RunOptions options;
    options.right = "sim";
    EventCount event_count;
    auto opened = open_hands(options, mesh, event_count);
    REQUIRE(opened);
    OpenHand& hand = opened->hands.front();
    constexpr Sensor sensor = Sensor::thumb_mcp;
    hand.wearer.right.calibration[sensor].gain_rad_per_count = 0.01;
    hand.wearer.right.size.length_m = 0.17;
    hand.wearer.left.calibration[sensor].gain_rad_per_count = 0.02;
    hand.wearer.left.size.length_m = 0.20;
    for (const Side side : {Side::right, Side::left, Side::right}) {
      hand.first.side = side; // a glove of that side was plugged into the box
      const auto placed = place_loop(options, opened->hands, mesh);
      REQUIRE(placed);
      const flow::HandInput& input = placed->setup.inputs.front();
      const bool swapped = side == Side::left;
      const auto gain = [&](Side glove) {
        return input.wearer.of(glove).calibration[sensor].gain_rad_per_count;
      };
      CHECK(gain(input.first.side) == (swapped ? 0.02 : 0.01));
      CHECK(gain(opposite(input.first.side)) == (swapped ? 0.01 : 0.02));
      const hand::HandSkeleton known(Side::right, {swapped ? 0.20 : 0.17});
      const auto tips = [](const hand::HandSkeleton& skeleton) {
        return skeleton.pose({}, Eigen::Isometry3d::Identity()).fingertip_positions();
      };
      CHECK(tips(input.skeleton(input.first.side)) == tips(known));
    }
  }
}

} // namespace place_loop_test
