#pragma once
// A hand as bones of an avatar, as the VMC protocol has them: Unity's HumanBodyBones, each with its
// pose relative to its parent bone. Sources: the protocol's description
// (protocol.vmc.info/english), and Unity's manual for the names.

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Geometry>

#include <nendo/hand/skeleton.hpp>
#include <nendo_publish.h>

#include "publish/osc_packer.hpp"

namespace nendo::publish {

struct BonePose {
  const char* name = ""; ///< "RightIndexProximal"
  /// In Unity's axes (x right, y up, z forward; left-handed), relative to the parent bone, of a
  /// skeleton without rotations in its T-pose; metres.
  std::array<float, 3> position_m{};
  std::array<float, 4> rotation_xyzw{};
};

/// Converts the poses of a hand's joints to bones. An avatar has no metacarpals but the thumb's:
/// the others are parts of the hand's bone.
class VmcHand {
public:
  static constexpr std::size_t bone_count = 16; ///< the hand, and three for each digit

  explicit VmcHand(const hand::HandSkeleton& skeleton);
  /// Returns the hand's bone, relative to the forearm, and then those of thumb to little finger,
  /// each from the palm to the tip.
  std::array<BonePose, bone_count> bones(const nendo_publish_hand& hand,
                                         const nendo_publish_joint& forearm) const;

private:
  Side side_;
  /// The rotations of the joints while the hand of an avatar is in its T-pose, inverted.
  std::array<Eigen::Quaternionf, hand::joint_count> from_rest_;
};

/// Adds the messages of a hand's bones.
void add_bones(std::span<const BonePose> bones, OscPacker& packer);

} // namespace nendo::publish
