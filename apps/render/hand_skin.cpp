#include "render/hand_skin.hpp"

#include <algorithm>
#include <cmath>

#include "render/skin_shape.hpp"

namespace nendo::render {

using Eigen::Vector3d;
using Eigen::Vector3f;
using hand::Joint;

namespace {

// Open, so that no flesh touches another finger's, and a little bent, halfway to where they go.
hand::JointAngles open_angles() {
  hand::JointAngles angles;
  angles.thumb_abduction_rad = 0.5;
  angles.thumb_roll_rad = 0.3;
  angles.thumb_mcp_flexion_rad = 0.1;
  angles.thumb_ip_flexion_rad = 0.1;
  constexpr std::array<double, 4> spread_rad{0.20, 0.02, -0.16, -0.32};
  for (std::size_t finger = 0; finger < 4; ++finger)
    angles.fingers[finger] = {0.25, spread_rad[finger], 0.3, 0.15};
  return angles;
}

// Of the skin at a place: the bones that are within reach_m of the nearest, the nearer the more.
constexpr float reach_m = 0.014F;
constexpr float nearness_m = 0.004F;

// Across a bone, from its size in the bind pose.
double length_of_hand(const hand::HandPose& pose) {
  const auto step = [&](Joint from, Joint to) {
    return (pose[to].translation() - pose[from].translation()).norm();
  };
  return step(Joint::wrist, Joint::middle_proximal) +
         step(Joint::middle_proximal, Joint::middle_intermediate) +
         step(Joint::middle_intermediate, Joint::middle_distal) +
         step(Joint::middle_distal, Joint::middle_tip);
}

} // namespace

hand::HandPose HandSkin::bind_pose(Side side) {
  return hand::HandSkeleton(side).pose(open_angles(), Eigen::Isometry3d::Identity());
}

std::array<HandSkin::JointShare, 4> HandSkin::influences(std::size_t place) const {
  const Influence& influence = influences_[place];
  std::array<JointShare, 4> shares;
  for (std::size_t rank = 0; rank < shares.size(); ++rank)
    shares[rank] = {fleshed_bones()[influence.bones[rank]].joint, influence.weights[rank]};
  return shares;
}

HandSkin::HandSkin(Side side) : bind_(bind_pose(side)) {
  const auto lines = bone_lines(bind_);
  SkinMesh mesh = skin_about(lines);
  places_ = std::move(mesh.places);
  corners_ = std::move(mesh.corners);
  for (const Vector3f& place : places_) {
    std::array<std::pair<float, std::uint8_t>, skin_bones> by_distance;
    for (std::size_t bone = 0; bone < skin_bones; ++bone)
      by_distance[bone] = {distance_to(fleshed_bones()[bone], lines[bone], place),
                           static_cast<std::uint8_t>(bone)};
    std::partial_sort(by_distance.begin(), by_distance.begin() + 4, by_distance.end());
    Influence influence;
    float sum = 0.0F;
    for (std::size_t rank = 0; rank < 4; ++rank) {
      const float beyond = by_distance[rank].first - by_distance[0].first;
      influence.bones[rank] = by_distance[rank].second;
      const float near = std::max(0.0F, 1.0F - beyond / reach_m) / (beyond + nearness_m);
      influence.weights[rank] = near * near;
      sum += influence.weights[rank];
    }
    for (float& weight : influence.weights)
      weight /= sum;
    influences_.push_back(influence);
  }
}

void HandSkin::drape(const hand::HandPose& pose, const Vector3d& origin_m, Surface& surface) const {
  const auto bind_lines = bone_lines(bind_);
  const auto lines = bone_lines(pose);
  const double across = length_of_hand(pose) / length_of_hand(bind_);
  std::array<Eigen::Affine3f, skin_bones> moves;
  for (std::size_t bone = 0; bone < skin_bones; ++bone) {
    const Joint joint = fleshed_bones()[bone].joint;
    const double before = static_cast<double>((bind_lines[bone].to - bind_lines[bone].from).norm());
    const double now = static_cast<double>((lines[bone].to - lines[bone].from).norm());
    const Eigen::Affine3d move = Eigen::Translation3d(-origin_m) * pose[joint] *
                                 Eigen::Scaling(across, across, before > 0 ? now / before : 1.0) *
                                 bind_[joint].inverse();
    moves[bone] = move.cast<float>();
  }
  surface.places.resize(places_.size());
  for (std::size_t place = 0; place < places_.size(); ++place) {
    const Influence& influence = influences_[place];
    Vector3f moved = Vector3f::Zero();
    for (std::size_t rank = 0; rank < 4; ++rank)
      moved += influence.weights[rank] * (moves[influence.bones[rank]] * places_[place]);
    surface.places[place] = moved;
  }
  surface.corners = corners_;
  compute_normals(surface.places, surface.corners, surface.normals);
}

void add_bones(const hand::HandPose& pose, const Vector3d& origin_m, Surface& surface) {
  constexpr float bone_radius_m = 0.0024F;
  constexpr float joint_radius_m = 0.0040F;
  for (std::size_t at = 0; at < hand::joint_count; ++at) {
    const auto joint = static_cast<Joint>(at);
    const auto parent = parent_of(joint);
    if (joint == Joint::palm) continue;
    const Vector3f place = (pose[joint].translation() - origin_m).cast<float>();
    const bool is_tip = std::find(hand::fingertips.begin(), hand::fingertips.end(), joint) !=
                        hand::fingertips.end();
    if (!is_tip) add_sphere(surface, place, joint_radius_m, 12);
    if (!parent) continue;
    const Vector3f base = (pose[*parent].translation() - origin_m).cast<float>();
    add_capsule(surface, base, place, bone_radius_m, bone_radius_m, 8);
  }
}

} // namespace nendo::render
