#include "export/motion_files.hpp"

#include <limits>

#include <doctest/doctest.h>

#include "support/csv_table.hpp"
#include "support/recorded_motion.hpp"
#include "support/scripted_frames.hpp"

namespace motion_csv_test {

using namespace nendo;
using namespace nendo::exporting;
using nendo::test::Motion;
using nendo::test::RecordedMotion;

TEST_SUITE("motion_csv") {
  TEST_CASE(
      "each frame's row has time, status, fingertips, and angles that make those fingertips") {
    const RecordedMotion motion(Motion{.ticks = 15, .commit_at_tick = 9});
    const auto source = motion.frames();
    auto frames = ChosenFrames::make(*source, {});
    REQUIRE(frames);
    REQUIRE(export_motion_csv(*frames, motion.path("take.csv")));
    auto table = test::csv_columns(test::file_bytes(motion.path("take.csv")));
    CHECK(table.size() == 6 + 2 * (3 + hand::angle_count + 15));
    REQUIRE(table["time_s"].size() == 15);
    CHECK(table["commits"][8] == "0");
    CHECK(table["commits"][9] == "1");
    CHECK(table["status"][3] == "0");
    CHECK((table["left_calibrated"][3] == "0" || table["left_calibrated"][3] == "1"));
    CHECK(table["held"][3] == "1");
    for (std::size_t row = 0; row < 15; ++row) {
      CHECK(std::stod(table["time_s"][row]) == doctest::Approx(motion.times_s[row]));
      for (const Side side : {Side::left, Side::right}) {
        const std::string name = std::string(name_of(side)) + "_";
        const std::size_t slot = flow::Placement::index_of(side);
        hand::JointAngles angles;
        for (std::size_t at = 0; at < hand::angle_count; ++at)
          angles[hand::angle_at(at)] = from_degrees(
              std::stod(table[name + std::string(hand::angle_names[at]) + "_deg"][row]));
        const auto pose =
            hand::HandSkeleton(side).pose(angles, motion.played.test.placement.T_stage_wrist[slot]);
        const auto tip = motion.hands[row][slot][hand::Joint::ring_tip].translation();
        CHECK((pose[hand::Joint::ring_tip].translation() - tip).norm() < 1e-5);
        CHECK(std::stod(table[name + "ring_tip_y_m"][row]) == doctest::Approx(tip.y()));
        CHECK(std::stod(table[name + "ring_tip_z_m"][row]) == doctest::Approx(tip.z()));
      }
    }
  }

  TEST_CASE("a number that is not finite is nan, and no other") {
    test::ScriptedFrames source({0.1, 0.2, 0.3});
    source.change = [](flow::Frame& frame) {
      for (std::size_t slot = 0; slot < 2; ++slot) {
        frame.hands[slot].present = true;
        frame.hands[slot].pose.joints.fill(Eigen::Isometry3d::Identity());
      }
      if (frame.tick != 1) return;
      frame.hands[0].angles.thumb_roll_rad = std::numeric_limits<double>::quiet_NaN();
      frame.hands[1].angles[hand::Finger::ring].mcp_flexion_rad =
          -std::numeric_limits<double>::infinity();
      frame.hands[1].pose.joints[hand::index_of(hand::Joint::little_tip)].translation().z() =
          std::numeric_limits<double>::infinity(); // the last cell of the row
    };
    auto frames = ChosenFrames::make(source, {});
    REQUIRE(frames);
    const test::TemporaryFolder folder;
    REQUIRE(export_motion_csv(*frames, folder.path() / "a.csv"));
    const auto table = test::csv_columns(test::file_bytes(folder.path() / "a.csv"));
    std::vector<std::string> missing;
    for (const auto& [name, cells] : table) {
      REQUIRE(cells.size() == 3);
      if (name.ends_with("_calibrated")) continue; // frames by a script have no calibration
      CHECK(cells[0] != "nan");
      if (cells[1] == "nan") missing.push_back(name);
    }
    CHECK(missing == std::vector<std::string>{"left_thumb_roll_deg", "right_little_tip_z_m",
                                              "right_ring_mcp_flexion_deg"});
  }
}

} // namespace motion_csv_test
