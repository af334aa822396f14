#include "export/hands_bvh.hpp"

#include <doctest/doctest.h>

#include "support/bvh_reader.hpp"
#include "support/recorded_motion.hpp"

using namespace nendo;
using namespace nendo::app;
using nendo::test::BvhRecording;
using nendo::test::Motion;
using nendo::test::RecordedMotion;

TEST_SUITE("hands_bvh") {
  TEST_CASE("each hand's file has its joints where they were, in centimetres") {
    const RecordedMotion motion(Motion{.ticks = 21});
    const auto source = motion.frames();
    auto frames = ChosenFrames::make(*source, {.rate_hz = 100.0});
    REQUIRE(frames);
    const auto done =
        export_hands_bvh(*frames, {hand::HandSkeleton(Side::left), hand::HandSkeleton(Side::right)},
                         motion.path("hands.bvh"));
    REQUIRE(done);
    REQUIRE(done->files.size() == 2);
    CHECK_FALSE(std::filesystem::exists(motion.path("hands.bvh")));
    for (const Side side : {Side::left, Side::right}) {
      const std::string suffix = side == Side::left ? "_L" : "_R";
      const BvhRecording bvh(
          test::file_bytes(motion.path("hands-" + std::string(name_of(side)) + ".bvh")));
      CHECK(bvh.declared_frames == 21);
      REQUIRE(bvh.frames.size() == 21);
      CHECK(bvh.frame_time_s == doctest::Approx(0.01));
      for (const std::size_t at : {0U, 7U, 20U}) {
        const auto world = bvh.world(at);
        const auto& pose = motion.hands[at][flow::Placement::index_of(side)];
        for (const hand::Joint joint : {hand::Joint::wrist, hand::Joint::index_distal,
                                        hand::Joint::thumb_proximal, hand::Joint::little_distal}) {
          const auto node = bvh.find(std::string(name_of(joint)) + suffix);
          CHECK((world[node].block<3, 1>(0, 3) - 100.0 * pose[joint].translation()).norm() < 1e-3);
        }
        const auto tip = bvh.find_end_of("index_distal" + suffix);
        CHECK((world[tip].block<3, 1>(0, 3) - 100.0 * pose[hand::Joint::index_tip].translation())
                  .norm() < 1e-3);
      }
    }
  }

  TEST_CASE("one hand has the name that was given, and no hand none") {
    const RecordedMotion motion(Motion{.ticks = 3});
    const auto source = motion.frames();
    auto frames = ChosenFrames::make(*source, {.rate_hz = 100.0});
    const auto done = export_hands_bvh(*frames, {std::nullopt, hand::HandSkeleton(Side::right)},
                                       motion.path("one.bvh"));
    REQUIRE(done);
    CHECK(done->files == std::vector<std::string>{motion.path("one.bvh").string()});
    const auto again = motion.frames();
    auto others = ChosenFrames::make(*again, {.rate_hz = 100.0});
    CHECK_FALSE(export_hands_bvh(*others, {}, motion.path("none.bvh")));
  }
}
