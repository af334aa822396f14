#pragma once
// A skin for the hand's bones: a closed surface about an open hand, made once, that follows any
// pose by the bones near it. It shows the pose; it is no measurement of a wearer's flesh.

#include <array>
#include <vector>

#include <nendo/hand/skeleton.hpp>
#include <nendo/viewer/surface.hpp>

namespace nendo::viewer {

class HandSkin {
public:
  /// Takes some ten milliseconds. Allocates.
  explicit HandSkin(Side side);

  /// The skin in that pose, moved by -origin_m; places, normals and corners of `surface` are
  /// replaced. Bones may be of any length: the skin is stretched along each, and as thick as the
  /// hand is large.
  void drape(const hand::HandPose& pose, const Eigen::Vector3d& origin_m, Surface& surface) const;

  /// The open hand about which the skin was made; its wrist is the origin.
  static hand::HandPose bind_pose(Side side);
  struct JointShare {
    hand::Joint joint;
    float weight; ///< sum 1; 0: not used
  };
  /// The joints that carry a place of drape()'s.
  std::array<JointShare, 4> influences(std::size_t place) const;

private:
  struct Influence {
    std::array<std::uint8_t, 4> bones{};
    std::array<float, 4> weights{}; ///< sum 1; 0: not used
  };

  hand::HandPose bind_;
  std::vector<Eigen::Vector3f> places_; ///< in the bind pose, whose wrist is the origin
  std::vector<Influence> influences_;
  std::vector<std::uint32_t> corners_;
};

/// Balls at the joints and bones between them, added to `surface`.
void add_bones(const hand::HandPose& pose, const Eigen::Vector3d& origin_m, Surface& surface);

} // namespace nendo::viewer
