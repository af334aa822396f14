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

  TEST_CASE("the paper's numbers are thumb 0-2, index 3-6, middle 7-10, ring 11-14, little 15-18") {
    using Kind = PaperNode::Kind;
    const auto joint = [](int id) { return PaperNode{Kind::joint, static_cast<std::uint8_t>(id)}; };
    CHECK(paper_node_of(Joint::wrist) == PaperNode{Kind::parent, 0});
    CHECK(paper_node_of(Joint::thumb_metacarpal) == PaperNode{Kind::palm_joint, 0});
    CHECK(paper_node_of(Joint::little_metacarpal) == PaperNode{Kind::palm_joint, 4});
    CHECK(paper_node_of(Joint::thumb_proximal) == joint(0));
    CHECK(paper_node_of(Joint::thumb_tip) == joint(2));
    // The joints that turn in two degrees of freedom are the fingers' MCPs.
    CHECK(paper_node_of(Joint::index_proximal) == joint(3));
    CHECK(paper_node_of(Joint::middle_proximal) == joint(7));
    CHECK(paper_node_of(Joint::ring_proximal) == joint(11));
    CHECK(paper_node_of(Joint::little_proximal) == joint(15));
    CHECK(paper_node_of(Joint::index_tip) == joint(6));
    CHECK(paper_node_of(Joint::little_tip) == joint(18));
    CHECK_FALSE(paper_node_of(Joint::palm).has_value());
  }

  TEST_CASE("the paper's nodes and the joints map one to one") {
    std::size_t nodes = 0;
    for (std::size_t at = 0; at < joint_count; ++at) {
      const auto joint = static_cast<Joint>(at);
      const auto node = paper_node_of(joint);
      if (!node) continue;
      ++nodes;
      CHECK(joint_of(*node) == joint);
    }
    CHECK(nodes == paper_node_count);
    CHECK_FALSE(joint_of({PaperNode::Kind::joint, 19}).has_value());
    CHECK_FALSE(joint_of({PaperNode::Kind::palm_joint, 5}).has_value());
  }
}

} // namespace joints_test
