#pragma once
// A hand's collision body, which presses against models: rounded cones for the bones of the
// fingers, and rounded triangles for the palm, without grooves. It follows all 26 joints. The drawn
// skin is finer, and lies within a few millimetres of the body.

#include <array>
#include <cstddef>

#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// The convex hull of two spheres (a rounded cone) or three (a rounded triangle). A sphere may
/// contain the others.
struct BodyPart {
  std::array<Eigen::Vector3d, 3> corners_m; ///< the centres; the third is unused in a cone
  std::array<double, 3> radii_m;            ///< the spheres' radii, >= 0
  std::size_t corner_count = 2;             ///< 2 or 3
  Joint carrier = Joint::wrist;             ///< the joint with which its surface moves
};

struct ClosestPoint {
  double distance_m = 0.0; ///< negative inside
  Eigen::Vector3d normal;  ///< outward unit vector: the gradient of the distance
  Eigen::Vector3d place_m; ///< on the surface
  std::size_t part = 0;    ///< index in HandBody::parts()
};

/// Returns the nearest surface point of one part, with ClosestPoint::part = 0. Exact inside and
/// outside, also for unequal radii. On the medial axis or triangle, it is one of several nearest
/// points. Wait-free.
NENDO_API ClosestPoint nearest_of(const BodyPart& part, const Eigen::Vector3d& place_m) noexcept;

class NENDO_API HandBody {
public:
  /// Three bones each for fingers and thumb; for the palm, six triangles between metacarpals and
  /// two towards the thumb; three webs between the fingers.
  static constexpr std::size_t part_count = 26;

  /// Uses the skeleton's bones; radii are those of an average hand, scaled by the hand's length.
  /// The initial pose has zero angles.
  explicit HandBody(const HandSkeleton& skeleton) noexcept;

  /// Moves the body to that pose; metres. Wait-free, no allocation.
  void follow(const HandPose& pose) noexcept;

  /// Returns the parts, always in the same order: thumb to little finger, each from root to tip,
  /// then the palm.
  const std::array<BodyPart, part_count>& parts() const noexcept { return parts_; }
  /// Returns the nearest surface point of the part with the least distance. Exact outside. Inside,
  /// the depth is that in this one part, which never exceeds the depth in the whole body.
  ClosestPoint nearest(const Eigen::Vector3d& place_m) const noexcept;

private:
  double scale_; ///< this hand's length over the average hand's
  std::array<BodyPart, part_count> parts_;
};

/// The radii of the hand's flesh about its joints, by index_of(Joint); metres. All > 0.
using JointRadii = std::array<double, joint_count>;

/// Returns the radii of the hand's body at its joints, at the tips those of the finger's end.
NENDO_API JointRadii joint_radii_m(const HandSkeleton& skeleton) noexcept;

struct FingerRadii {
  float knuckle_mm, middle_mm, end_mm, tip_mm; ///< from the knuckle to the tip
};
/// Radii of a hand 187 mm long, thumb to little finger: between ANSUR II's women and men (2012), or
/// estimated by eye. The drawn skin has the same. The thumb has no middle joint.
inline constexpr std::array<FingerRadii, finger_count> average_finger_radii{
    {{11.8F, 10.2F, 9.8F, 8.0F},
     {10.2F, 8.8F, 7.8F, 6.7F},
     {10.4F, 9.0F, 8.0F, 6.9F},
     {9.8F, 8.4F, 7.5F, 6.5F},
     {8.8F, 7.4F, 6.6F, 5.8F}}};

} // namespace nendo::hand
