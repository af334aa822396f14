#pragma once
// The thickness of a hand around its bones, and the surface around them.

#include <array>
#include <vector>

#include <nendo/hand/joints.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::render {

/// One bone with its flesh: a cone with balls at its ends. It moves with `joint`.
struct FleshedBone {
  hand::Joint joint; ///< at its base
  hand::Joint end;   ///< where it ends; `joint` itself for the forearm
  float radius_m;
  float end_radius_m;
};

inline constexpr std::size_t palm_bones = 6;  ///< these come first: forearm and metacarpals
inline constexpr std::size_t skin_bones = 20; ///< the other ones are those of the fingers

const std::array<FleshedBone, skin_bones>& fleshed_bones() noexcept;

/// The places where a bone begins and ends.
struct BoneLine {
  Eigen::Vector3f from, to;
};
std::array<BoneLine, skin_bones> bone_lines(const hand::HandPose& pose);

/// Returns the distance of `place` from a bone's flesh. It is negative inside.
float distance_to(const FleshedBone& bone, const BoneLine& line, const Eigen::Vector3f& place);

struct SkinMesh {
  std::vector<Eigen::Vector3f> places;
  std::vector<std::uint32_t> corners; ///< three for each triangle
};

/// Returns the closed surface around all bones. Flesh is joined smoothly along a finger and in the
/// palm, but not between fingers.
SkinMesh skin_about(const std::array<BoneLine, skin_bones>& lines);

} // namespace nendo::render
