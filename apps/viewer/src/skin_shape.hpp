#pragma once
// How thick a hand is about its bones, and the surface about them.

#include <array>
#include <vector>

#include <nendo/hand/joints.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::viewer {

/// One bone with its flesh, a cone with balls at its ends. It moves with `joint`.
struct FleshedBone {
  hand::Joint joint; ///< at its base
  hand::Joint end;   ///< where it ends; the joint itself: the forearm, away from the hand
  float radius_m;
  float end_radius_m;
};

inline constexpr std::size_t palm_bones = 6;  ///< the first: forearm and metacarpals
inline constexpr std::size_t skin_bones = 20; ///< the others are fingers', in threes and a pair

const std::array<FleshedBone, skin_bones>& fleshed_bones() noexcept;

/// Where a bone begins and ends.
struct BoneLine {
  Eigen::Vector3f from, to;
};
std::array<BoneLine, skin_bones> bone_lines(const hand::HandPose& pose);

/// From a point to a bone's flesh; negative inside.
float distance_to(const FleshedBone& bone, const BoneLine& line, const Eigen::Vector3f& place);

struct SkinMesh {
  std::vector<Eigen::Vector3f> places;
  std::vector<std::uint32_t> corners; ///< three a triangle
};

/// The closed surface about all of them: flesh runs together along a finger and in the palm, but
/// not between fingers.
SkinMesh skin_about(const std::array<BoneLine, skin_bones>& lines);

} // namespace nendo::viewer
