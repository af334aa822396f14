#include "export/motion_files.hpp"

#include <doctest/doctest.h>

#include "support/bvh_reader.hpp"
#include "support/recorded_motion.hpp"
#include "support/scripted_frames.hpp"
#include "support/small_disk.hpp"

namespace hands_bvh_test {

using namespace nendo;
using namespace nendo::exporting;
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

  TEST_CASE("whatever goes wrong on the way, neither hand has a new file, and the old ones stay") {
    const Skeletons both{hand::HandSkeleton(Side::left), hand::HandSkeleton(Side::right)};
    const test::TemporaryFolder folder;
    const auto left = folder.path() / "a-left.bvh";
    const auto right = folder.path() / "a-right.bvh";
    test::write_bytes(left, "old");
    const auto check_kept = [&](const Result<Exported>& done, Errc code) {
      REQUIRE_FALSE(done);
      CHECK(done.error().code == code);
      CHECK(test::file_bytes(left) == "old");
      CHECK_FALSE(std::filesystem::exists(right));
      const std::filesystem::directory_iterator files(folder.path());
      CHECK(std::distance(begin(files), end(files)) == 1); // nothing temporary
    };
    test::ScriptedFrames broken({0.1, 0.2, 0.3});
    broken.change = [](flow::Frame& frame) {
      for (auto& hand : frame.hands)
        hand.pose.joints.fill(Eigen::Isometry3d::Identity());
      if (frame.tick == 2)
        frame.hands[1].pose.joints[hand::index_of(hand::Joint::wrist)].translation().x() =
            std::nan("");
    };
    auto frames = ChosenFrames::make(broken, {.rate_hz = 10.0});
    REQUIRE(frames);
    check_kept(export_hands_bvh(*frames, both, folder.path() / "a.bvh"), Errc::bad_input);
    const RecordedMotion motion(Motion{.ticks = 5});
    const auto export_to = [&](const std::filesystem::path& path) {
      const auto source = motion.frames();
      auto fine = ChosenFrames::make(*source, {.rate_hz = 100.0});
      REQUIRE(fine);
      return export_hands_bvh(*fine, both, path);
    };
    REQUIRE(export_to(motion.path("b.bvh")));
    const rlim_t most = std::max(std::filesystem::file_size(motion.path("b-left.bvh")),
                                 std::filesystem::file_size(motion.path("b-right.bvh")));
    for (const rlim_t space : {rlim_t{100}, most - 1}) { // in the head, and in the last frame
      Result<Exported> done = Exported{};
      {
        const test::SmallDisk small(space);
        done = export_to(folder.path() / "a.bvh");
      }
      check_kept(done, Errc::failed);
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

} // namespace hands_bvh_test
