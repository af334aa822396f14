#pragma once
// The body of a hand, which presses against models: rounded cones for the bones of the fingers, and
// rounded triangles for the palm, which has no grooves. It follows all 26 joints. It is what
// touches; the drawn skin is finer, and lies within a few millimetres of it.

#include <array>
#include <cstddef>

#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// The convex hull of two balls (a rounded cone) or of three (a rounded triangle). A ball may
/// contain the others.
struct BodyPart {
  std::array<Eigen::Vector3d, 3> corners_m; ///< the centres; the third is unused in a cone
  std::array<double, 3> radii_m;            ///< the balls' radii, >= 0
  std::size_t corner_count = 2;             ///< 2 or 3
  Joint carrier = Joint::wrist;             ///< the joint with which its surface turns and slides
};

struct ClosestPoint {
  double distance_m = 0.0; ///< negative inside
  Eigen::Vector3d normal;  ///< unit, outwards: the gradient of the distance
  Eigen::Vector3d place_m; ///< on the surface
  std::size_t part = 0;    ///< index in HandBody::parts()
};

/// Returns the nearest place of one part (its `part` is 0). It is exact, inside as well as outside,
/// also where radii differ. On the medial axis or triangle, where several places are nearest, it
/// is one of them. Wait-free.
NENDO_API ClosestPoint nearest_of(const BodyPart& part, const Eigen::Vector3d& place_m) noexcept;

class NENDO_API HandBody {
public:
  /// Three bones a finger and the thumb's three; of the palm, six triangles between metacarpals and
  /// two towards the thumb; and three webs between the fingers.
  static constexpr std::size_t part_count = 26;

  /// Takes the wearer's sizes: radii are those of an average hand, scaled with its length. The body
  /// is in the pose of zero angles.
  explicit HandBody(const HandSkeleton& skeleton) noexcept;

  /// Moves the body to that pose; metres. Wait-free, no allocation.
  void follow(const HandPose& pose) noexcept;

  /// Returns the parts, always in the same order: thumb to little finger from their roots to their
  /// ends, then the palm.
  const std::array<BodyPart, part_count>& parts() const noexcept { return parts_; }
  /// Returns the nearest place of the surface of the whole: that of the part with the least
  /// distance. Outside it is exact. Inside, the depth is that in the one part, and never more than
  /// the way out of the whole.
  ClosestPoint nearest(const Eigen::Vector3d& place_m) const noexcept;

private:
  double scale_; ///< this hand's length, of the average hand's
  std::array<BodyPart, part_count> parts_;
};

struct FingerRadii {
  float knuckle_mm, middle_mm, end_mm, tip_mm; ///< from the knuckle to the tip
};
/// Those of a hand of 187 mm, thumb to little finger: between ANSUR II's women and men (2012) where
/// it has them, and otherwise by eye. The drawn skin has the same. The thumb has no middle joint.
inline constexpr std::array<FingerRadii, finger_count> average_finger_radii{
    {{11.8F, 10.2F, 9.8F, 8.0F},
     {10.2F, 8.8F, 7.8F, 6.7F},
     {10.4F, 9.0F, 8.0F, 6.9F},
     {9.8F, 8.4F, 7.5F, 6.5F},
     {8.8F, 7.4F, 6.6F, 5.8F}}};

} // namespace nendo::hand
