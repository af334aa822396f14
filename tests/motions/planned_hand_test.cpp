#include "motions/planned_hand.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include <doctest/doctest.h>

#include "support/test_meshes.hpp"

namespace planned_hand_test {

using namespace nendo;

TEST_SUITE("planned_hand") {
  TEST_CASE("all motions have names of their own, and move a hand at a model") {
    const deform::Mesh ball = test::sphere(16, 24, 1.0);
    motions::PlannedHand planned{ball, 0.8, Side::right};
    std::set<std::string_view> names;
    for (const driver::NamedMotion& motion : motions::planned_motions(&planned)) {
      CAPTURE(motion.name);
      CHECK(names.insert(motion.name).second);
      planned.T_stage_wrist.reset();
      planned.wrist_path.reset();
      const auto made = motion.make({});
      REQUIRE(made);
      REQUIRE(planned.T_stage_wrist);
      REQUIRE((planned.wrist_path == nullptr) == (motion.name == "touch"));
      if (const auto& path = planned.wrist_path) {
        CHECK(path->at(0.0).isApprox(*planned.T_stage_wrist));
        double farthest_m = 0.0;
        for (int k = 1; k < 16; ++k) {
          const Eigen::Vector3d place_m = path->at(k * path->length_s() / 16.0).translation();
          farthest_m = std::max(farthest_m, (place_m - path->at(0.0).translation()).norm());
        }
        CHECK(farthest_m > 0.01);
      } else {
        CHECK((*made)(0.0) != (*made)(3.7));
      }
    }
    CHECK(names.size() == 8);
  }

  TEST_CASE("without a model they say where there is one") {
    for (const driver::NamedMotion& motion : motions::planned_motions(nullptr)) {
      const auto made = motion.make({.source = "sim:it"});
      REQUIRE_FALSE(made);
      CHECK(made.error().code == Errc::usage);
      CHECK(made.error().message.starts_with("sim:it: needs a model"));
      CHECK(made.error().message.find("nendo run") != std::string::npos);
    }
  }
}

} // namespace planned_hand_test
