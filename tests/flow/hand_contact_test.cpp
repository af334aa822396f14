#include <nendo/flow/clay_hands.hpp>

#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "support/random_poses.hpp"

namespace hand_contact_test {

using namespace nendo;

TEST_SUITE("hand_contact") {
  TEST_CASE("parts are the hand's body in model units, and go with the joints that carry them") {
    std::mt19937 random(61);
    const hand::HandSkeleton skeleton(Side::left);
    hand::HandBody body(skeleton);
    std::vector<deform::ContactPart> parts(hand::HandBody::part_count);
    constexpr double units_per_metre = 250.0;
    for (int trial = 0; trial < 5; ++trial) {
      const hand::HandPose pose = skeleton.pose({}, test::random_place(random));
      flow::contact_parts(body, pose, units_per_metre, parts);
      hand::HandBody reference(skeleton);
      reference.follow(pose);
      for (std::size_t at = 0; at < parts.size(); ++at) {
        const hand::BodyPart& from = reference.parts()[at];
        REQUIRE(parts[at].corner_count == from.corner_count);
        for (std::size_t corner = 0; corner < from.corner_count; ++corner) {
          CHECK((parts[at].corners[corner] / units_per_metre - from.corners_m[corner]).norm() <
                1e-12);
          CHECK(parts[at].radii[corner] == doctest::Approx(units_per_metre * from.radii_m[corner]));
        }
        // A place of the carrying bone has the same numbers in the part's frame.
        const Eigen::Vector3d on_bone(0.01, -0.02, 0.005);
        const Eigen::Vector3d there = units_per_metre * (pose[from.carrier] * on_bone);
        CHECK((parts[at].frame.inverse() * there - units_per_metre * on_bone).norm() < 1e-9);
      }
    }
  }
}

} // namespace hand_contact_test
