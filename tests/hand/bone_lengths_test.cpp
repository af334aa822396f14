#include <limits>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include <nendo/hand/skeleton.hpp>

namespace bone_lengths_test {

using namespace nendo;
using namespace nendo::hand;

namespace {

double between(const HandPose& pose, Joint a, Joint b) {
  return (pose[a].translation() - pose[b].translation()).norm();
}

BoneLengths usual() {
  return HandSkeleton(Side::right).bones();
}

} // namespace

TEST_SUITE("bone_lengths") {
  TEST_CASE("a hand made of measured bones has these bones") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> length(BoneLengths::min_m, BoneLengths::max_m);
    constexpr Joint metacarpals[] = {Joint::index_metacarpal, Joint::middle_metacarpal,
                                     Joint::ring_metacarpal, Joint::little_metacarpal};
    for (int round = 0; round < 100; ++round) {
      BoneLengths bones;
      for (double& bone : bones.thumb_m)
        bone = length(random);
      for (auto& finger : bones.fingers_m) {
        for (double& bone : finger)
          bone = length(random);
      }
      const auto skeleton = HandSkeleton::of_bones(Side::left, bones);
      REQUIRE(skeleton);
      const HandPose pose = skeleton->pose({}, Eigen::Isometry3d::Identity());
      for (std::size_t bone = 0; bone < 3; ++bone) {
        const auto at = static_cast<Joint>(index_of(Joint::thumb_metacarpal) + bone);
        const auto end = static_cast<Joint>(index_of(at) + 1);
        CHECK(between(pose, at, end) == doctest::Approx(bones.thumb_m[bone]));
      }
      for (std::size_t f = 0; f < 4; ++f) {
        for (std::size_t bone = 0; bone < 4; ++bone) {
          const auto at = static_cast<Joint>(index_of(metacarpals[f]) + bone);
          const auto end = static_cast<Joint>(index_of(at) + 1);
          CHECK(between(pose, at, end) == doctest::Approx(bones.fingers_m[f][bone]));
        }
      }
    }
  }

  TEST_CASE("a hand's own bones give back the hand, of any size with average proportions") {
    for (const double scale : {0.7, 1.0, 1.3}) {
      const HandSkeleton sized(Side::right, {scale * 0.187, scale * 0.083});
      const auto measured = HandSkeleton::of_bones(Side::right, sized.bones());
      REQUIRE(measured);
      for (std::size_t at = 0; at < joint_count; ++at) {
        const auto joint = static_cast<Joint>(at);
        CHECK((sized.rest_offset(joint) - measured->rest_offset(joint)).norm() < 1e-12);
      }
    }
  }

  TEST_CASE("what cannot be a bone is refused, by its name") {
    for (const double wrong :
         {0.0, -0.05, 0.0009, 0.201, 45.0, std::numeric_limits<double>::quiet_NaN(),
          std::numeric_limits<double>::infinity()}) {
      CAPTURE(wrong);
      BoneLengths bones = usual();
      bones.fingers_m[2][3] = wrong;
      const auto finger = HandSkeleton::of_bones(Side::right, bones);
      REQUIRE_FALSE(finger);
      CHECK(finger.error().code == Errc::bad_input);
      CHECK(finger.error().message.find("ring distal") != std::string::npos);
      CHECK(finger.error().message.find('\n') == std::string::npos);
      bones = usual();
      bones.thumb_m[0] = wrong;
      const auto thumb = HandSkeleton::of_bones(Side::left, bones);
      REQUIRE_FALSE(thumb);
      CHECK(thumb.error().message.find("thumb metacarpal") != std::string::npos);
    }
    BoneLengths ends = usual();
    ends.thumb_m[1] = BoneLengths::min_m;
    ends.fingers_m[0][0] = BoneLengths::max_m;
    CHECK(ends.check());
  }
}

} // namespace bone_lengths_test
