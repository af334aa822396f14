#include <nendo/hand/hand_body.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nendo::hand {
namespace {

using Eigen::Vector3d;

/// A ball of the family whose hull a part is, and how far the place is from it.
struct BallNear {
  double distance_m = std::numeric_limits<double>::infinity();
  Vector3d centre_m = Vector3d::Zero();
  double radius_m = 0.0;
};

BallNear ball(const Vector3d& centre_m, double radius_m, const Vector3d& place_m) noexcept {
  return {(place_m - centre_m).norm() - radius_m, centre_m, radius_m};
}

const BallNear& nearer(const BallNear& a, const BallNear& b) noexcept {
  return b.distance_m < a.distance_m ? b : a;
}

// The distance from the balls between two corners is convex along the axis. Where radii differ, the
// nearest ball is not that under the place, but farther to the thick end by the cone's slope.
BallNear ball_of_cone(const BodyPart& part, std::size_t first, std::size_t second,
                      const Vector3d& place_m) noexcept {
  const Vector3d& from_m = part.corners_m[first];
  const Vector3d way_m = part.corners_m[second] - from_m;
  const double growth_m = part.radii_m[second] - part.radii_m[first];
  const double length_m = way_m.norm();
  if (length_m <= std::abs(growth_m)) // one ball contains the other
    return ball(part.corners_m[growth_m > 0.0 ? second : first],
                part.radii_m[growth_m > 0.0 ? second : first], place_m);
  const Vector3d axis = way_m / length_m;
  const double slope = growth_m / length_m;
  const double along_m = (place_m - from_m).dot(axis);
  const double across_m = (place_m - from_m - along_m * axis).norm();
  const double to_thick_m = across_m * slope / std::sqrt(1.0 - slope * slope);
  const double share = std::clamp((along_m + to_thick_m) / length_m, 0.0, 1.0);
  return ball(from_m + share * way_m, part.radii_m[first] + share * growth_m, place_m);
}

struct Facet {
  Vector3d normal, slope;
  bool is_plane;
};

Facet facet_of(const BodyPart& part) noexcept {
  const Vector3d u = part.corners_m[1] - part.corners_m[0];
  const Vector3d v = part.corners_m[2] - part.corners_m[0];
  const Vector3d across = u.cross(v);
  const double area = across.norm();
  const bool is_flat = area > 1e-12 * (u.squaredNorm() + v.squaredNorm());
  if (!is_flat) return {Vector3d::Zero(), Vector3d::Zero(), false};
  const Vector3d normal = across / area;
  const Vector3d slope = ((part.radii_m[1] - part.radii_m[0]) * v.cross(normal) +
                          (part.radii_m[2] - part.radii_m[0]) * normal.cross(u)) /
                         area;
  return {normal, slope, slope.squaredNorm() < 1.0};
}

// As for a cone: in a plane the distance from the balls is convex. If its least is not within
// the triangle, it is on an edge.
BallNear ball_of_triangle(const BodyPart& part, const Vector3d& place_m) noexcept {
  const Vector3d& corner_m = part.corners_m[0];
  if (const Facet facet = facet_of(part); facet.is_plane) {
    const double height_m = (place_m - corner_m).dot(facet.normal);
    const double to_thick_m = std::abs(height_m) / std::sqrt(1.0 - facet.slope.squaredNorm());
    const Vector3d foot_m = place_m - height_m * facet.normal + to_thick_m * facet.slope;
    const auto side = [&](std::size_t from, std::size_t to) {
      return (part.corners_m[to] - part.corners_m[from])
          .cross(foot_m - part.corners_m[from])
          .dot(facet.normal);
    };
    if (side(0, 1) >= 0.0 && side(1, 2) >= 0.0 && side(2, 0) >= 0.0)
      return ball(foot_m, part.radii_m[0] + facet.slope.dot(foot_m - corner_m), place_m);
  }
  return nearer(nearer(ball_of_cone(part, 0, 1, place_m), ball_of_cone(part, 1, 2, place_m)),
                ball_of_cone(part, 2, 0, place_m));
}

// Out of a place on the axis or the triangle itself, any way that leads to the surface.
Vector3d way_out(const BodyPart& part) noexcept {
  if (part.corner_count == 3)
    if (const Facet facet = facet_of(part); facet.is_plane) return facet.normal;
  const Vector3d way = part.corners_m[1] - part.corners_m[0];
  return way.norm() > 0.0 ? way.unitOrthogonal() : Vector3d::UnitZ();
}

double middle_finger_m(const HandSkeleton& skeleton) noexcept {
  double sum_m = 0.0;
  for (std::size_t bone = 1; bone <= 4; ++bone)
    sum_m += skeleton.rest_offset(joint_after(Joint::middle_metacarpal, bone)).norm();
  return sum_m;
}

/// How much longer the hand is than the average hand.
double scale_of(const HandSkeleton& skeleton) noexcept {
  return middle_finger_m(skeleton) / middle_finger_m(HandSkeleton(skeleton.side()));
}

// Radii of an average hand's palm, in millimetres.
constexpr double thumb_base_mm = 14.0;
constexpr double heel_mm = 11.5;
constexpr double head_mm = 12.0; ///< at the heads of the metacarpals

/// Writes one part after the other. Measures are those of an average hand, in millimetres.
class Builder {
public:
  Builder(const HandPose& pose, double scale, std::array<BodyPart, HandBody::part_count>& parts)
      : pose_(pose), scale_m_(0.001 * scale), parts_(parts) {}

  void add_all() noexcept {
    add_thumb();
    for (std::size_t finger = 1; finger < finger_count; ++finger)
      add_finger(finger);
    for (std::size_t finger = 1; finger + 1 < finger_count; ++finger)
      add_palm(finger);
    add_thumb_side();
    for (std::size_t finger = 1; finger + 1 < finger_count; ++finger)
      add_web(finger);
  }

private:
  struct Corner {
    Vector3d place_m;
    double radius_m;
  };

  Vector3d place(Joint joint) const noexcept { return pose_[joint].translation(); }
  /// Under a joint, on the side of the palm.
  Vector3d below(Joint joint, double by_mm) const noexcept {
    return pose_[joint] * Vector3d(0.0, -by_mm * scale_m_, 0.0);
  }
  Corner corner(const Vector3d& place_m, double radius_mm) const noexcept {
    return {place_m, radius_mm * scale_m_};
  }
  Corner corner(const Vector3d& place_m, float radius_mm) const noexcept {
    return corner(place_m, static_cast<double>(radius_mm));
  }
  void add(const Corner& from, const Corner& to, Joint carrier) noexcept {
    parts_[count_++] = {{from.place_m, to.place_m, to.place_m},
                        {from.radius_m, to.radius_m, to.radius_m},
                        2,
                        carrier};
  }
  void add(const Corner& a, const Corner& b, const Corner& c, Joint carrier) noexcept {
    parts_[count_++] = {
        {a.place_m, b.place_m, c.place_m}, {a.radius_m, b.radius_m, c.radius_m}, 3, carrier};
  }
  /// The last ball of a finger ends where the finger ends.
  Corner end_of(const Vector3d& from_m, const Vector3d& tip_m, float of_tip_mm) const noexcept {
    const auto radius_mm = static_cast<double>(of_tip_mm);
    const double length_m = (tip_m - from_m).norm();
    const double share = length_m > 0.0 ? std::min(1.0, radius_mm * scale_m_ / length_m) : 0.0;
    return corner(tip_m - share * (tip_m - from_m), radius_mm);
  }

  void add_thumb() noexcept {
    const FingerRadii& radii = average_finger_radii[0];
    const Corner base = corner(place(metacarpals[0]), thumb_base_mm);
    const Corner knuckle = corner(place(Joint::thumb_proximal), radii.knuckle_mm);
    const Corner end = corner(place(Joint::thumb_distal), radii.end_mm);
    add(base, knuckle, Joint::thumb_metacarpal);
    add(knuckle, end, Joint::thumb_proximal);
    add(end, end_of(end.place_m, place(Joint::thumb_tip), radii.tip_mm), Joint::thumb_distal);
  }

  // Bones lie nearer to the back of a finger than to its pad.
  void add_finger(std::size_t finger) noexcept {
    const FingerRadii& radii = average_finger_radii[finger];
    const Joint joint = joint_after(metacarpals[finger], 1);
    const Corner knuckle = corner(below(joint, 1.0), radii.knuckle_mm);
    const Corner middle = corner(below(joint_after(joint, 1), 1.0), radii.middle_mm);
    const Corner end = corner(below(joint_after(joint, 2), 1.0), radii.end_mm);
    add(knuckle, middle, joint);
    add(middle, end, joint_after(joint, 1));
    add(end, end_of(end.place_m, below(joint_after(joint, 3), 1.0), radii.tip_mm),
        joint_after(joint, 2));
  }

  // Most flesh of the palm lies below the bones.
  Corner heel(std::size_t finger) const noexcept {
    return corner(below(metacarpals[finger], 5.0), heel_mm);
  }
  Corner head(std::size_t finger) const noexcept {
    return corner(below(metacarpals[finger], 4.5) + place(joint_after(metacarpals[finger], 1)) -
                      place(metacarpals[finger]),
                  head_mm);
  }
  void add_palm(std::size_t finger) noexcept {
    add(heel(finger), head(finger), head(finger + 1), metacarpals[finger]);
    add(heel(finger), head(finger + 1), heel(finger + 1), metacarpals[finger + 1]);
  }

  // The ball of the thumb runs into the palm.
  void add_thumb_side() noexcept {
    const Corner base = corner(place(metacarpals[0]), thumb_base_mm);
    const Corner on_thumb =
        corner(0.34 * place(metacarpals[0]) + 0.66 * place(Joint::thumb_proximal), 10.0);
    const Corner on_index =
        corner(0.4 * below(metacarpals[1], 3.0) + 0.6 * below(Joint::index_proximal, 3.0), 9.5);
    add(base, on_thumb, on_index, Joint::thumb_metacarpal);
    add(base, on_index, heel(1), Joint::wrist);
  }

  // Fingers part from one another well after their knuckles.
  void add_web(std::size_t finger) noexcept {
    const auto beside = [&](std::size_t which) {
      const Joint joint = joint_after(metacarpals[which], 1);
      return corner(0.66 * below(joint, 2.5) + 0.34 * below(joint_after(joint, 1), 2.5), 5.0);
    };
    add(beside(finger), beside(finger + 1), joint_after(metacarpals[finger], 1));
  }

  const HandPose& pose_;
  double scale_m_; ///< metres a millimetre of the average hand
  std::array<BodyPart, HandBody::part_count>& parts_;
  std::size_t count_ = 0;
};

} // namespace

ClosestPoint nearest_of(const BodyPart& part, const Vector3d& place_m) noexcept {
  const BallNear near =
      part.corner_count == 3 ? ball_of_triangle(part, place_m) : ball_of_cone(part, 0, 1, place_m);
  const Vector3d away_m = place_m - near.centre_m;
  const double length_m = away_m.norm();
  const Vector3d normal = length_m > 0.0 ? Vector3d(away_m / length_m) : way_out(part);
  return {near.distance_m, normal, near.centre_m + near.radius_m * normal, 0};
}

HandBody::HandBody(const HandSkeleton& skeleton) noexcept : scale_(scale_of(skeleton)) {
  follow(skeleton.pose({}, Eigen::Isometry3d::Identity()));
}

void HandBody::follow(const HandPose& pose) noexcept {
  Builder(pose, scale_, parts_).add_all();
}

ClosestPoint HandBody::nearest(const Vector3d& place_m) const noexcept {
  ClosestPoint best = nearest_of(parts_[0], place_m);
  for (std::size_t at = 1; at < part_count; ++at) {
    const ClosestPoint other = nearest_of(parts_[at], place_m);
    if (other.distance_m >= best.distance_m) continue;
    best = other;
    best.part = at;
  }
  return best;
}

JointRadii joint_radii_m(const HandSkeleton& skeleton) noexcept {
  const double scale_m = 0.001 * scale_of(skeleton);
  JointRadii radii{};
  radii[index_of(Joint::palm)] = head_mm * scale_m;
  radii[index_of(Joint::wrist)] = heel_mm * scale_m;
  for (std::size_t finger = 0; finger < finger_count; ++finger) {
    const auto& [knuckle_mm, middle_mm, end_mm, tip_mm] = average_finger_radii[finger];
    double* at = &radii[index_of(metacarpals[finger])];
    *at++ = (finger == 0 ? thumb_base_mm : heel_mm) * scale_m;
    *at++ = static_cast<double>(knuckle_mm) * scale_m;
    if (finger > 0) *at++ = static_cast<double>(middle_mm) * scale_m;
    *at++ = static_cast<double>(end_mm) * scale_m;
    *at = static_cast<double>(tip_mm) * scale_m;
  }
  return radii;
}

} // namespace nendo::hand
