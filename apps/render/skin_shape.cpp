#include "render/skin_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nendo/hand/hand_body.hpp>

namespace nendo::render {

using Eigen::Vector3f;
using hand::HandPose;
using hand::Joint;

namespace {

constexpr float mm = 0.001F;

// Over which flesh runs together.
constexpr float along_finger_m = 3.5F * mm;
constexpr float in_palm_m = 14 * mm;
constexpr float at_knuckles_m = 10 * mm;
constexpr float at_thumb_m = 14 * mm;
constexpr float between_fingers_m = 6 * mm; // only where they leave the palm
constexpr float at_cut_m = 13 * mm;

constexpr std::array<Joint, 5> roots{Joint::thumb_metacarpal, Joint::index_metacarpal,
                                     Joint::middle_metacarpal, Joint::ring_metacarpal,
                                     Joint::little_metacarpal};

Joint after(Joint joint, std::size_t steps) {
  return static_cast<Joint>(hand::index_of(joint) + steps);
}
Vector3f place_of(const HandPose& pose, Joint joint) {
  return pose[joint].translation().cast<float>();
}
// The axes of a joint: to the right, out of the back of the hand, and back to the wrist.
Vector3f axis_of(const HandPose& pose, Joint joint, Eigen::Index axis) {
  return pose[joint].linear().col(axis).cast<float>();
}
Vector3f between(const Vector3f& a, const Vector3f& b, float share) {
  return a + share * (b - a);
}

FleshPart round_part(const Vector3f& from, const Vector3f& to, float radius_m, float end_radius_m,
                     float soft_m, std::array<Joint, 2> carriers) {
  return {from, to, radius_m, end_radius_m, soft_m, Vector3f::Zero(), 1.0F, carriers};
}

// The lesser of two distances, rounded where they are within `soft` of each other.
float soft_min(float a, float b, float soft) noexcept {
  const float h = std::max(0.0F, soft - std::abs(a - b)) / soft;
  return std::min(a, b) - 0.25F * h * h * soft;
}

float union_of(const std::vector<FleshPart>& parts, const Vector3f& place) noexcept {
  float whole = distance_to(parts.front(), place);
  for (std::size_t at = 1; at < parts.size(); ++at)
    whole = soft_min(whole, distance_to(parts[at], place), parts[at].soft_m);
  return whole;
}

// From the part's beginning, in a space in which the part is round.
Vector3f flattened(const FleshPart& part, const Vector3f& place) noexcept {
  Vector3f from = place - part.from;
  if (part.flatness < 1.0F)
    from += (1.0F / part.flatness - 1.0F) * from.dot(part.flat_along) * part.flat_along;
  return from;
}

void prepare(std::vector<FleshPart>& parts) {
  for (FleshPart& part : parts) {
    part.way = part.to - part.from;
    part.way += (1.0F / part.flatness - 1.0F) * part.way.dot(part.flat_along) * part.flat_along;
    const float squared = part.way.squaredNorm();
    part.per_squared = squared > 0.0F ? 1.0F / squared : 0.0F;
  }
}

Eigen::AlignedBox3f box_of(const std::vector<FleshPart>& parts) {
  Eigen::AlignedBox3f box;
  for (const FleshPart& part : parts)
    for (const auto& [end, radius_m] :
         {std::pair{part.from, part.radius_m}, {part.to, part.end_radius_m}}) {
      box.extend(end + Vector3f::Constant(radius_m));
      box.extend(end - Vector3f::Constant(radius_m));
    }
  return box;
}

} // namespace

float distance_to(const FleshPart& part, const Vector3f& place) noexcept {
  const Vector3f from = flattened(part, place);
  const float t = std::clamp(part.per_squared * from.dot(part.way), 0.0F, 1.0F);
  return (from - t * part.way).norm() - (part.radius_m + t * (part.end_radius_m - part.radius_m));
}

float share_along(const FleshPart& part, const Vector3f& place) noexcept {
  return std::clamp(part.per_squared * flattened(part, place).dot(part.way), 0.0F, 1.0F);
}

HandFlesh::HandFlesh(const HandPose& pose) {
  add_metacarpals(pose);
  add_thumb_side(pose);
  add_webs(pose);
  add_forearm(pose);
  add_thumb(pose);
  for (std::size_t finger = 1; finger < roots.size(); ++finger)
    add_finger(pose, finger);
  prepare(palm_);
  palm_box_ = box_of(palm_);
  for (std::size_t finger = 0; finger < roots.size(); ++finger) {
    prepare(fingers_[finger]);
    finger_boxes_[finger] = box_of(fingers_[finger]);
  }
}

// The bones lie near the back of the hand, and most flesh lies on the side of the palm.
void HandFlesh::add_metacarpals(const HandPose& pose) {
  const Vector3f right = axis_of(pose, Joint::wrist, 0);
  const Vector3f up = axis_of(pose, Joint::wrist, 1);
  const Vector3f back = axis_of(pose, Joint::wrist, 2);
  for (std::size_t finger = 1; finger < roots.size(); ++finger) {
    const Joint root = roots[finger];
    const float head = hand::average_finger_radii[finger].knuckle_mm * mm;
    // Those of index and middle finger are fixed to the wrist.
    const Joint carrier = finger < 3 ? Joint::wrist : root;
    palm_.push_back(round_part(place_of(pose, root) - 4.5F * mm * up,
                               place_of(pose, after(root, 1)) - 2 * mm * up, 10 * mm, head,
                               in_palm_m, {Joint::wrist, carrier}));
  }
  // The pads below the knuckles.
  const Vector3f first = place_of(pose, Joint::index_proximal);
  const Vector3f last = place_of(pose, Joint::little_proximal);
  palm_.push_back(round_part(first - 9 * mm * up - 1 * mm * back + 1 * mm * right,
                             last - 8 * mm * up - 1 * mm * back - 1 * mm * right, 8.5F * mm, 8 * mm,
                             12 * mm, {Joint::wrist, Joint::little_metacarpal}));
  // The heel of the hand, on the little finger's side.
  palm_.push_back(round_part(
      place_of(pose, Joint::little_metacarpal) - 6 * mm * up + 2 * mm * right - 4 * mm * back,
      between(place_of(pose, Joint::little_metacarpal), last, 0.7F) - 5 * mm * up + 1 * mm * right,
      13 * mm, 10.5F * mm, in_palm_m, {Joint::wrist, Joint::little_metacarpal}));
}

// The ball of the thumb, and the web between thumb and index finger.
void HandFlesh::add_thumb_side(const HandPose& pose) {
  const Vector3f up = axis_of(pose, Joint::wrist, 1);
  const Vector3f wrist = place_of(pose, Joint::wrist);
  const Vector3f base = place_of(pose, Joint::thumb_metacarpal);
  const Vector3f head = place_of(pose, Joint::thumb_proximal);
  palm_.push_back(round_part(between(wrist, base, 0.65F) - 3 * mm * up,
                             between(base, head, 0.7F) - 1 * mm * up, 13 * mm, 13 * mm, in_palm_m,
                             {Joint::wrist, Joint::thumb_metacarpal}));
  const Vector3f index =
      between(place_of(pose, Joint::index_metacarpal), place_of(pose, Joint::index_proximal), 0.6F);
  palm_.push_back(round_part(index - 3 * mm * up, between(base, head, 0.66F), 9 * mm, 9.5F * mm,
                             16 * mm, {Joint::wrist, Joint::thumb_metacarpal}));
}

// Fingers part from one another well after their knuckles.
void HandFlesh::add_webs(const HandPose& pose) {
  for (std::size_t finger = 1; finger + 1 < roots.size(); ++finger) {
    const auto beside = [&](std::size_t which) -> Vector3f {
      const Joint proximal = after(roots[which], 1);
      return between(place_of(pose, proximal), place_of(pose, after(proximal, 1)), 0.34F) -
             2.5F * mm * axis_of(pose, proximal, 1);
    };
    palm_.push_back(round_part(beside(finger), beside(finger + 1), 5 * mm, 5 * mm, 10 * mm,
                               {after(roots[finger], 1), after(roots[finger + 1], 1)}));
  }
}

void HandFlesh::add_forearm(const HandPose& pose) {
  const Vector3f right = axis_of(pose, Joint::wrist, 0);
  const Vector3f up = axis_of(pose, Joint::wrist, 1);
  const Vector3f back = axis_of(pose, Joint::wrist, 2);
  const Vector3f wrist = place_of(pose, Joint::wrist) + 1.5F * mm * right - 2 * mm * up;
  palm_.push_back({wrist + 2 * mm * back,
                   wrist + 70 * mm * back,
                   25 * mm,
                   30 * mm,
                   22 * mm,
                   up,
                   0.68F,
                   {Joint::wrist, Joint::wrist}});
  cut_place_ = wrist + 50 * mm * back;
  cut_normal_ = back;
}

void HandFlesh::add_thumb(const HandPose& pose) {
  const hand::FingerRadii& radii = hand::average_finger_radii[0];
  const auto at = [&](std::size_t step) { return place_of(pose, after(roots[0], step)); };
  const auto carried = [](std::size_t step) {
    return std::array{after(roots[0], step), after(roots[0], step)};
  };
  const Vector3f up = axis_of(pose, Joint::thumb_distal, 1);
  const Vector3f along = (at(3) - at(2)).normalized();
  std::vector<FleshPart>& parts = fingers_[0];
  parts.push_back(round_part(at(0), at(1), 14 * mm, radii.knuckle_mm * mm, 0.0F, carried(0)));
  parts.push_back(round_part(at(1), at(2), radii.knuckle_mm * mm, radii.end_mm * mm, along_finger_m,
                             carried(1)));
  parts.push_back({at(2), at(3) - radii.tip_mm * mm * along, radii.end_mm * mm, radii.tip_mm * mm,
                   along_finger_m, up, 0.85F, carried(2)});
  // The pad of its end.
  parts.push_back(round_part(between(at(2), at(3), 0.4F) - 2.5F * mm * up,
                             between(at(2), at(3), 0.62F) - 2 * mm * up, 7.6F * mm, 7 * mm,
                             along_finger_m, carried(2)));
}

void HandFlesh::add_finger(const HandPose& pose, std::size_t finger) {
  const hand::FingerRadii& radii = hand::average_finger_radii[finger];
  const std::array<float, 4> radius_m{radii.knuckle_mm * mm, radii.middle_mm * mm,
                                      radii.end_mm * mm, radii.tip_mm * mm};
  std::vector<FleshPart>& parts = fingers_[finger];
  for (std::size_t bone = 0; bone < 3; ++bone) {
    const Joint joint = after(roots[finger], bone + 1);
    const Vector3f up = axis_of(pose, joint, 1);
    const Vector3f from = place_of(pose, joint) - 1 * mm * up;
    const Vector3f to = place_of(pose, after(joint, 1)) - 1 * mm * up;
    const bool is_last = bone == 2;
    const Vector3f end = is_last ? Vector3f(to - radius_m[3] * (to - from).normalized()) : to;
    parts.push_back({from,
                     end,
                     radius_m[bone],
                     radius_m[bone + 1],
                     along_finger_m,
                     up,
                     is_last ? 0.88F : 0.95F,
                     {joint, joint}});
    // Its pad: the flesh between two creases.
    const float pad = 0.87F * radius_m[bone + 1];
    parts.push_back(
        round_part(between(from, to, 0.35F) - 0.30F * radius_m[bone + 1] * up,
                   between(from, to, is_last ? 0.62F : 0.70F) - 0.26F * radius_m[bone + 1] * up,
                   pad, pad, along_finger_m, {joint, joint}));
  }
}

float HandFlesh::operator()(const Vector3f& place) const noexcept {
  constexpr float far_m = 0.03F; // farther than anything runs together
  float palm = palm_box_.exteriorDistance(place);
  // Rounded where it is cut: the greater of two is minus the lesser of both negated.
  if (palm < far_m)
    palm = -soft_min(-union_of(palm_, place), -(place - cut_place_).dot(cut_normal_), at_cut_m);
  const float near_palm = std::clamp(1.0F - palm / at_knuckles_m, 0.0F, 1.0F);
  const float soft = std::max(1e-6F, near_palm * between_fingers_m);
  float fingers = 1.0F; // more than there is
  for (std::size_t finger = 1; finger < fingers_.size(); ++finger)
    if (finger_boxes_[finger].exteriorDistance(place) <= palm + at_knuckles_m)
      fingers = soft_min(fingers, union_of(fingers_[finger], place), soft);
  const float hand = soft_min(fingers, palm, at_knuckles_m);
  if (finger_boxes_[0].exteriorDistance(place) > palm + at_thumb_m) return hand;
  return std::min(hand, soft_min(union_of(fingers_[0], place), palm, at_thumb_m));
}

Eigen::AlignedBox3f HandFlesh::box() const {
  Eigen::AlignedBox3f box = palm_box_;
  for (const auto& finger : finger_boxes_)
    box.extend(finger);
  return {box.min() - Vector3f::Constant(slack_m), box.max() + Vector3f::Constant(slack_m)};
}

} // namespace nendo::render
