#include <nendo/hand/calibration_poses.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include <doctest/doctest.h>

namespace calibration_poses_test {

using namespace nendo;
using namespace nendo::hand;

namespace {

constexpr double rad = std::numbers::pi / 180.0;

} // namespace

TEST_SUITE("calibration_poses") {
  TEST_CASE("every pose has a name of its own, is found by it, and is asked for in a sentence") {
    std::set<std::string> names;
    for (const PoseId id : full_poses()) {
      const CalibrationPose& pose = pose_of(id);
      CAPTURE(std::string(pose.name));
      CHECK(names.insert(std::string(pose.name)).second);
      CHECK(pose_named(pose.name) == id);
      CHECK(pose.instruction.ends_with('.'));
      CHECK(pose.instruction.size() <= 80);
    }
    CHECK(names.size() == pose_count);
    CHECK_FALSE(pose_named("pinch").has_value());
    CHECK_FALSE(pose_named("").has_value());
  }

  TEST_CASE("the quick poses are a flat hand and a fist, and among the full ones") {
    CHECK(quick_poses().size() == 2);
    CHECK(pose_of(quick_poses()[0]).name == "flat");
    CHECK(pose_of(quick_poses()[1]).name == "fist");
    const auto full = full_poses();
    for (const PoseId id : quick_poses())
      CHECK(std::count(full.begin(), full.end(), id) == 1);
  }

  TEST_CASE("a full calibration takes every pose, then some once more, but never at once") {
    const auto full = full_poses(), takes = full_takes();
    REQUIRE(takes.size() > full.size());
    // At five seconds each, and half a minute of free motion: three minutes and a half.
    CHECK(takes.size() <= 36);
    CHECK(std::equal(full.begin(), full.end(), takes.begin()));
    for (std::size_t k = 1; k < takes.size(); ++k)
      CHECK(takes[k] != takes[k - 1]);
    for (const PoseId id : full)
      CHECK(std::count(takes.begin(), takes.end(), id) <= 3);
  }

  TEST_CASE(
      "every PIP joint is bent once by something other than feel, and nothing straight is by it") {
    for (const Sensor pip :
         {Sensor::index_pip, Sensor::middle_pip, Sensor::ring_pip, Sensor::little_pip}) {
      const auto full = full_poses();
      CHECK(std::count_if(full.begin(), full.end(), [&](PoseId id) {
              const AssumedAngle& assumed = pose_of(id).assumed[static_cast<std::size_t>(pip)];
              return assumed.angle_rad > 80.0 * rad && !assumed.by_feel;
            }) == 1);
    }
    for (const PoseId id : full_poses())
      for (const AssumedAngle& assumed : pose_of(id).assumed)
        CHECK_FALSE((assumed.by_feel && std::abs(assumed.angle_rad) < 5.0 * rad));
  }

  TEST_CASE("together the poses show every sensor of a 22-sensor glove two different angles") {
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      if (!sensors_22.has(static_cast<Sensor>(slot))) continue;
      CAPTURE(std::string(name_of(static_cast<Sensor>(slot))));
      double low = 10.0, high = -10.0, deviation = 0.0;
      for (const PoseId id : full_poses()) {
        const AssumedAngle& assumed = pose_of(id).assumed[slot];
        if (!assumed.known()) continue;
        low = std::min(low, assumed.angle_rad);
        high = std::max(high, assumed.angle_rad);
        deviation = std::max(deviation, assumed.deviation_rad);
      }
      CHECK(high - low > 1.2 * deviation);
      CHECK(low <= 0.0);
    }
  }

  TEST_CASE("no pose asks for what a joint cannot do, or for exact angles") {
    for (const PoseId id : full_poses()) {
      for (const AssumedAngle& assumed : pose_of(id).assumed) {
        CHECK(std::abs(assumed.angle_rad) <= 100.0 * rad);
        if (assumed.known()) CHECK(assumed.deviation_rad >= 2.0 * rad - 1e-9);
        if (assumed.known()) CHECK(assumed.deviation_rad <= 15.0 * rad + 1e-9);
      }
      if (const auto& touch = pose_of(id).touch; touch) {
        CHECK(touch->deviation_m > 0.0);
        const bool finger =
            std::find(fingertips.begin() + 1, fingertips.end(), touch->with) != fingertips.end();
        CHECK((finger || touch->with == Joint::little_proximal));
      }
    }
  }
}

} // namespace calibration_poses_test
