#pragma once
// The flesh of a right hand in one pose: flattened cones about its bones, joined smoothly; and
// triangles about it.

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/hand/joints.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::render {

/// A cone with round ends. It carries the skin near it along with one or two joints.
struct FleshPart {
  Eigen::Vector3f from, to; ///< metres
  float radius_m;           ///< at `from`
  float end_radius_m;
  float soft_m;               ///< over which it runs together with the parts before it
  Eigen::Vector3f flat_along; ///< unit; zero: it is round
  float flatness;             ///< its thickness along `flat_along`, of its width; at most 1
  std::array<hand::Joint, 2> carriers; ///< at `from` and at `to`
  // Made of the above by prepare(), for distance_to().
  Eigen::Vector3f way = Eigen::Vector3f::Zero();
  float per_squared = 0.0F;
};

/// Returns the distance of `place` from the part. It is negative inside, exact for round parts of
/// even thickness, and elsewhere too large by at most 1 / flatness.
float distance_to(const FleshPart& part, const Eigen::Vector3f& place) noexcept;

/// Returns how far along the part it is nearest to `place`: 0 is `from`, and 1 is `to`.
float share_along(const FleshPart& part, const Eigen::Vector3f& place) noexcept;

/// The whole hand. Radii are those of a hand of 187 mm, between ANSUR II's women and men (2012)
/// where it has them, and otherwise by eye.
class HandFlesh {
public:
  /// `pose` is that of an open right hand, so that no finger touches another one. Allocates.
  explicit HandFlesh(const hand::HandPose& pose);

  /// Returns the distance from the skin, negative inside. Its zero is a smooth, closed surface:
  /// each finger runs together with the palm, but never with another finger.
  float operator()(const Eigen::Vector3f& place) const noexcept;
  /// |distance(a) - distance(b)| <= steepness * |a - b| + slack_m.
  static constexpr float steepness = 1.6F;
  static constexpr float slack_m = 0.008F;

  const std::vector<FleshPart>& palm() const noexcept { return palm_; }
  /// Thumb to little finger.
  const std::array<std::vector<FleshPart>, 5>& fingers() const noexcept { return fingers_; }
  /// Returns a box that has the whole skin in it.
  Eigen::AlignedBox3f box() const;

private:
  void add_metacarpals(const hand::HandPose& pose);
  void add_thumb_side(const hand::HandPose& pose);
  void add_webs(const hand::HandPose& pose);
  void add_forearm(const hand::HandPose& pose);
  void add_thumb(const hand::HandPose& pose);
  void add_finger(const hand::HandPose& pose, std::size_t finger);

  std::vector<FleshPart> palm_;
  std::array<std::vector<FleshPart>, 5> fingers_;
  Eigen::AlignedBox3f palm_box_;
  std::array<Eigen::AlignedBox3f, 5> finger_boxes_;
  Eigen::Vector3f cut_place_, cut_normal_; ///< where the forearm ends
};

struct SkinMesh {
  std::vector<Eigen::Vector3f> places;
  std::vector<std::uint32_t> corners; ///< three for each triangle, counter-clockwise from outside
};

/// Returns the surface where the distance is zero, in cells that are thinner than the flesh. It is
/// closed, has about 1.3 places for each square of a cell's side, and its triangles are nearly
/// even. Allocates.
SkinMesh net_about(const HandFlesh& flesh, float cell_m);

/// Returns for each place those that it shares an edge with.
std::vector<std::vector<std::uint32_t>> neighbours_in(const SkinMesh& mesh);

} // namespace nendo::render
