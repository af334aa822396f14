#include <nendo/hand/joints.hpp>

#include <set>
#include <string>

#include <doctest/doctest.h>

namespace joints_test {

using namespace nendo::hand;

TEST_SUITE("joints") {
  TEST_CASE("the order is OpenXR's") {
    // XrHandJointEXT's numbers, from the OpenXR 1.0 specification.
    CHECK(index_of(Joint::palm) == 0);
    CHECK(index_of(Joint::wrist) == 1);
    CHECK(index_of(Joint::thumb_metacarpal) == 2);
    CHECK(index_of(Joint::thumb_tip) == 5);
    CHECK(index_of(Joint::index_metacarpal) == 6);
    CHECK(index_of(Joint::index_tip) == 10);
    CHECK(index_of(Joint::middle_metacarpal) == 11);
    CHECK(index_of(Joint::ring_metacarpal) == 16);
    CHECK(index_of(Joint::little_metacarpal) == 21);
    CHECK(index_of(Joint::little_tip) == joint_count - 1);
    CHECK(name_of(Joint::little_intermediate) == "little_intermediate");
  }

  TEST_CASE("names are all different") {
    std::set<std::string> names;
    for (std::size_t at = 0; at < joint_count; ++at)
      names.emplace(name_of(static_cast<Joint>(at)));
    CHECK(names.size() == joint_count);
  }

  TEST_CASE("a fingertip is called after its finger") {
    for (std::size_t at = 0; at < finger_count; ++at)
      CHECK(name_of(fingertips[at]) == std::string(name_of(static_cast<Finger>(at))) + "_tip");
  }

  TEST_CASE("every joint but the wrist hangs, in the end, on the wrist") {
    CHECK_FALSE(parent_of(Joint::wrist).has_value());
    for (std::size_t at = 0; at < joint_count; ++at) {
      auto joint = static_cast<Joint>(at);
      int steps = 0;
      while (const auto parent = parent_of(joint)) {
        joint = *parent;
        REQUIRE(++steps <= 5);
      }
      CHECK(joint == Joint::wrist);
    }
    CHECK(parent_of(Joint::thumb_metacarpal) == Joint::wrist);
    CHECK(parent_of(Joint::little_tip) == Joint::little_distal);
  }
}

} // namespace joints_test
