#pragma once
// The skin of a hand. It is a closed surface around an open hand, which is made once and then
// follows any pose by the joints near it. It shows the pose and does not measure a wearer's flesh.

#include <array>
#include <vector>

#include <nendo/hand/skeleton.hpp>

#include "render/surface.hpp"

namespace nendo::render {

struct JointShare {
  hand::Joint joint{};
  float weight = 0.0F; ///< none is negative, and the sum is 1; 0 means not used
};
/// Up to four joints that carry a place, the strongest first.
using SkinInfluence = std::array<JointShare, 4>;

class HandSkin {
public:
  /// How the movements of the joints that carry a place are mixed.
  enum class Mix {
    screws, ///< as dual quaternions: a bent or twisted joint keeps its thickness (L. Kavan, S.
            ///< Collins, J. Zara, C. O'Sullivan, "Skinning with dual quaternions", I3D 2007)
    linear, ///< as matrices: it gets thinner; this is all that glTF has
  };

  static constexpr float fine_cell_m = 0.0034F; ///< the cell of some five thousand places
  static constexpr float coarse_cell_m = 0.006F;

  /// Makes the skin, which takes some tens of milliseconds. Its triangles are about as large as a
  /// cell. Allocates.
  explicit HandSkin(Side side, float cell_m = fine_cell_m);

  /// Computes the skin in that pose, moved by -origin_m, and replaces positions, normals and
  /// corners of `surface`. Bones may have any length: the skin is stretched along each bone, and
  /// its thickness follows the size of the hand. Allocates where `surface` is too small.
  void drape(const hand::HandPose& pose, const Eigen::Vector3d& origin_m, Surface& surface,
             Mix mix = Mix::screws) const;

  /// Returns the pose of the open hand around which the skin was made. Its wrist is the origin.
  static hand::HandPose bind_pose(Side side);
  /// Returns the joints that carry one of the positions that drape() makes.
  const SkinInfluence& influences(std::size_t place) const { return influences_[place]; }

private:
  hand::HandPose bind_;
  std::vector<Eigen::Vector3f> places_; ///< in the bind pose
  std::vector<SkinInfluence> influences_;
  std::vector<std::uint32_t> corners_;
};

/// Adds balls at the joints, and the bones between them, to `surface`.
void add_bones(const hand::HandPose& pose, const Eigen::Vector3d& origin_m, Surface& surface);

} // namespace nendo::render
