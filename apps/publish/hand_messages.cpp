#include "publish/hand_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <nendo/hand/joint_limits.hpp>
#include <nendo/hand/joints.hpp>

namespace nendo::publish {
namespace {

using hand::Angle;
using hand::Finger;
using hand::Joint;

/// The distance of the tips of thumb and index finger at which a pinch counts as open.
constexpr float open_pinch_m = 0.06F;

/// Returns the flexion of a finger, or of the thumb: 0 straight, 1 bent as far as joints go.
float flexion_of(Finger finger, const nendo_publish_hand_state& state) {
  constexpr std::array thumb{Angle::thumb_mcp_flexion, Angle::thumb_ip_flexion};
  const auto first = static_cast<std::size_t>(finger) * 4; // of the finger's angles, in their order
  const std::array of_finger{hand::angle_at(first), hand::angle_at(first + 2),
                             hand::angle_at(first + 3)};
  const std::span<const Angle> angles =
      finger == Finger::thumb ? std::span<const Angle>(thumb) : std::span<const Angle>(of_finger);
  double sum_rad = 0.0, max_rad = 0.0;
  for (const Angle angle : angles) {
    sum_rad += state.angles[hand::index_of(angle)];
    max_rad += hand::joint_limits[hand::index_of(angle)].soft_max_rad;
  }
  return static_cast<float>(std::clamp(sum_rad / max_rad, 0.0, 1.0));
}

float pinch_of(const nendo_publish_hand& hand) {
  const auto& thumb = hand.joints[hand::index_of(Joint::thumb_tip)].position;
  const auto& index = hand.joints[hand::index_of(Joint::index_tip)].position;
  const float distance_m =
      std::hypot(thumb[0] - index[0], thumb[1] - index[1], thumb[2] - index[2]);
  return std::clamp(1.0F - distance_m / open_pinch_m, 0.0F, 1.0F);
}

std::array<float, 7> pose_of(const nendo_publish_joint& joint) {
  std::array<float, 7> pose{};
  std::copy_n(joint.position, 3, pose.begin());
  std::copy_n(joint.orientation, 4, pose.begin() + 3);
  return pose;
}

} // namespace

void add_hand_messages(Side side, const nendo_publish_hand& hand,
                       const nendo_publish_hand_state& state, OscPacker& packer) {
  const std::string root = "/nendo/" + std::string(name_of(side));
  const auto add = [&](const std::string& path, std::span<const float> numbers) {
    packer.add((root + path).c_str(), numbers);
  };
  const auto add_one = [&](const std::string& path, float number) { add(path, {&number, 1}); };
  packer.add((root + "/live").c_str(), (hand.flags & NENDO_PUBLISH_SILENT) == 0 ? 1 : 0);
  add("/wrist", pose_of(hand.joints[hand::index_of(Joint::wrist)]));
  for (std::size_t at = 0; at < hand::finger_count; ++at) {
    const auto finger = static_cast<Finger>(at);
    const std::string name = "/" + std::string(hand::name_of(finger));
    add_one(name + "/flexion", flexion_of(finger, state));
    add(name + "/tip", {hand.joints[hand::index_of(hand::fingertips[at])].position, 3});
    add_one(name + "/touch", state.touch[at]);
  }
  add_one("/palm/touch", state.touch[hand::finger_count]);
  add_one("/pinch", pinch_of(hand));
  std::array<float, NENDO_PUBLISH_ANGLES> angles_rad{};
  std::transform(std::begin(state.angles), std::end(state.angles), angles_rad.begin(),
                 [](double angle_rad) { return static_cast<float>(angle_rad); });
  add("/angles", angles_rad);
  if ((state.flags & NENDO_PUBLISH_HAS_SWITCH) != 0)
    packer.add((root + "/switch").c_str(), (state.flags & NENDO_PUBLISH_SWITCH_ON) != 0 ? 1 : 0);
}

} // namespace nendo::publish
