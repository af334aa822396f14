#include "publish/vmc_bones.hpp"

#include <algorithm>

#include <nendo/base/units.hpp>

namespace nendo::publish {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3f;
using hand::Joint;

/// Receivers that set positions need a forearm; an avatar's own is as long as it is.
constexpr float forearm_m = 0.25F;

struct Bone {
  const char *left, *right;
  Joint joint; ///< which it begins at
  int parent;  ///< index of its parent bone; -1: the forearm
};
constexpr std::array<Bone, VmcHand::bone_count> bone_table{{
    {"LeftHand", "RightHand", Joint::wrist, -1},
    {"LeftThumbProximal", "RightThumbProximal", Joint::thumb_metacarpal, 0},
    {"LeftThumbIntermediate", "RightThumbIntermediate", Joint::thumb_proximal, 1},
    {"LeftThumbDistal", "RightThumbDistal", Joint::thumb_distal, 2},
    {"LeftIndexProximal", "RightIndexProximal", Joint::index_proximal, 0},
    {"LeftIndexIntermediate", "RightIndexIntermediate", Joint::index_intermediate, 4},
    {"LeftIndexDistal", "RightIndexDistal", Joint::index_distal, 5},
    {"LeftMiddleProximal", "RightMiddleProximal", Joint::middle_proximal, 0},
    {"LeftMiddleIntermediate", "RightMiddleIntermediate", Joint::middle_intermediate, 7},
    {"LeftMiddleDistal", "RightMiddleDistal", Joint::middle_distal, 8},
    {"LeftRingProximal", "RightRingProximal", Joint::ring_proximal, 0},
    {"LeftRingIntermediate", "RightRingIntermediate", Joint::ring_intermediate, 10},
    {"LeftRingDistal", "RightRingDistal", Joint::ring_distal, 11},
    {"LeftLittleProximal", "RightLittleProximal", Joint::little_proximal, 0},
    {"LeftLittleIntermediate", "RightLittleIntermediate", Joint::little_intermediate, 13},
    {"LeftLittleDistal", "RightLittleDistal", Joint::little_distal, 14},
}};

/// Returns the wrist's turn in a T-pose: the arm points to its side, and the palm looks down.
Eigen::Matrix3d rest_turn(Side side) {
  const double outwards = side == Side::right ? 1.0 : -1.0;
  Eigen::Matrix3d axes; // columns: x, the back of the hand, and away from the fingers
  axes << 0.0, 0.0, -outwards, 0.0, 1.0, 0.0, outwards, 0.0, 0.0;
  return axes;
}

/// Avatars' thumbs point away from the hand at rest; by how much differs between them.
hand::JointAngles rest_angles() {
  hand::JointAngles angles;
  angles.thumb_abduction_rad = from_degrees(30.0);
  return angles;
}

Quaternionf turn_of(const nendo_publish_joint& joint) {
  return {joint.orientation[3], joint.orientation[0], joint.orientation[1], joint.orientation[2]};
}
Vector3f position_of(const nendo_publish_joint& joint) {
  return {joint.position[0], joint.position[1], joint.position[2]};
}

} // namespace

VmcHand::VmcHand(const hand::HandSkeleton& skeleton) : side_(skeleton.side()) {
  Eigen::Isometry3d T_rest = Eigen::Isometry3d::Identity();
  T_rest.linear() = rest_turn(side_);
  const hand::HandPose rest = skeleton.pose(rest_angles(), T_rest);
  for (std::size_t at = 0; at < from_rest_.size(); ++at)
    from_rest_[at] = Eigen::Quaterniond(rest.joints[at].linear()).cast<float>().conjugate();
}

std::array<BonePose, VmcHand::bone_count> VmcHand::bones(const nendo_publish_hand& hand,
                                                         const nendo_publish_joint& forearm) const {
  const bool is_right = side_ == Side::right;
  std::array<BonePose, bone_count> bones;
  std::array<Quaternionf, bone_count> turns; ///< since the T-pose, on the stage
  const Quaternionf of_forearm = turn_of(forearm) * from_rest_[hand::index_of(Joint::wrist)];
  for (std::size_t at = 0; at < bone_count; ++at) {
    const Bone& bone = bone_table[at];
    const std::size_t joint = hand::index_of(bone.joint);
    turns[at] = turn_of(hand.joints[joint]) * from_rest_[joint];
    const auto parent = static_cast<std::size_t>(std::max(bone.parent, 0));
    const Quaternionf to_parent = (bone.parent < 0 ? of_forearm : turns[parent]).conjugate();
    const Quaternionf turn = (to_parent * turns[at]).normalized();
    const Vector3f position_m =
        bone.parent < 0
            ? Vector3f(is_right ? forearm_m : -forearm_m, 0.0F, 0.0F)
            : to_parent *
                  Vector3f(position_of(hand.joints[joint]) -
                           position_of(hand.joints[hand::index_of(bone_table[parent].joint)]));
    // The stage has z towards the operator, Unity away from him.
    bones[at] = {is_right ? bone.right : bone.left,
                 {position_m.x(), position_m.y(), -position_m.z()},
                 {-turn.x(), -turn.y(), turn.z(), turn.w()}};
  }
  return bones;
}

void add_bones(std::span<const BonePose> bones, OscPacker& packer) {
  for (const BonePose& bone : bones) {
    std::array<float, 7> numbers{};
    std::copy(bone.position_m.begin(), bone.position_m.end(), numbers.begin());
    std::copy(bone.rotation_xyzw.begin(), bone.rotation_xyzw.end(), numbers.begin() + 3);
    packer.add("/VMC/Ext/Bone/Pos", bone.name, numbers);
  }
}

} // namespace nendo::publish
