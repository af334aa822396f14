#include "takes/take.hpp"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "support/scripted_frames.hpp"

namespace key_poses_test {

using namespace nendo;
using test::ScriptedFrames;

namespace {

std::vector<double> times(std::size_t count) {
  std::vector<double> all;
  for (std::size_t at = 0; at < count; ++at)
    all.push_back(0.01 * static_cast<double>(at));
  return all;
}

/// One function after another rises to its peak and falls again, 100 frames each.
void play_one_after_another(flow::Frame& frame) {
  frame.function_count = 3;
  frame.functions.fill(0.0F);
  const double in = static_cast<double>(frame.tick % 100) / 100.0;
  if (frame.tick < 300)
    frame.functions[frame.tick / 100] = static_cast<float>(std::sin(3.14159265 * in));
}

} // namespace

TEST_SUITE("key_poses") {
  TEST_CASE("they are the first frame, and the peaks of the played functions, in their order") {
    ScriptedFrames frames(times(400));
    frames.change = play_one_after_another;
    const auto found = takes::key_poses(frames, 4);
    REQUIRE(found.size() == 4);
    CHECK(found[0] == 0.0);
    for (std::size_t peak = 0; peak < 3; ++peak)
      CHECK(found[peak + 1] == doctest::Approx(0.5 + static_cast<double>(peak)));
  }

  TEST_CASE("without a puppet, the hands' angles decide, and nothing is chosen twice") {
    ScriptedFrames frames(times(100));
    frames.change = [](flow::Frame& frame) {
      frame.hands[1].present = true;
      frame.hands[1].angles.wrist_yaw_rad = frame.tick < 40 ? 0.0 : frame.tick < 70 ? 0.5 : -0.2;
    };
    const auto found = takes::key_poses(frames, 10);
    REQUIRE(found.size() == 3);
    CHECK(found[0] == 0.0);
    CHECK((found[1] >= times(100)[40] && found[1] < times(100)[70]));
    CHECK(found[2] >= times(100)[70]);
    ScriptedFrames still(times(5));
    CHECK(takes::key_poses(still, 3) == std::vector<double>{0.0});
    ScriptedFrames empty({});
    CHECK(takes::key_poses(empty, 3).empty());
  }

  TEST_CASE("a pose that is held comes before a farther one on the way to another") {
    ScriptedFrames frames(times(400));
    frames.change = [](flow::Frame& frame) {
      frame.function_count = 2;
      const double time_s = 0.01 * static_cast<double>(frame.tick);
      frame.functions[0] = static_cast<float>(std::clamp(time_s - 0.5, 0.0, 1.0)); // 0.5 on its way
      frame.functions[1] = static_cast<float>(std::clamp(time_s - 2.5, 0.0, 0.4));
    };
    const auto found = takes::key_poses(frames, 3);
    REQUIRE(found.size() == 3);
    CHECK(found[0] == 0.0);
    CHECK((found[1] > 1.4 && found[1] < 2.6));
    CHECK(found[2] > 2.8);
  }

  TEST_CASE("of a long take a few frames are left out, and its peaks are found all the same") {
    ScriptedFrames frames(times(50'000));
    frames.change = [](flow::Frame& frame) {
      frame.function_count = 1;
      frame.functions[0] =
          static_cast<float>(1.0 - std::abs(static_cast<double>(frame.tick) - 33'333.0) / 50'000.0);
    };
    const auto found = takes::key_poses(frames, 2);
    REQUIRE(found.size() == 2);
    CHECK(found[1] == doctest::Approx(333.33).epsilon(1e-4));
  }
}

} // namespace key_poses_test
