#include "render/hand_skin.hpp"

#include <algorithm>
#include <optional>
#include <utility>

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

// Where a bone that begins in a joint ends, if it is one bone.
std::optional<Joint> end_of(Joint joint) {
  if (joint == Joint::palm || joint == Joint::wrist) return std::nullopt;
  const bool is_tip =
      std::find(hand::fingertips.begin(), hand::fingertips.end(), joint) != hand::fingertips.end();
  if (is_tip) return std::nullopt;
  return static_cast<Joint>(hand::index_of(joint) + 1);
}

// The pose with the wearer's bones and the angles of `turns`. Its wrist is the origin.
hand::HandPose with_bones_of(const hand::HandPose& bones, const hand::HandPose& turns) {
  hand::HandPose pose = turns;
  for (std::size_t step = 0; step < hand::joint_count; ++step) {
    // The palm, joint 0, hangs on the wrist, joint 1.
    const auto joint = static_cast<Joint>((step + 1) % hand::joint_count);
    const auto parent = parent_of(joint);
    if (!parent) continue;
    const Vector3d offset = bones[*parent].inverse() * bones[joint].translation();
    pose.joints[hand::index_of(joint)].translation() = pose[*parent] * offset;
  }
  return pose;
}

using Stretches = std::array<Eigen::Affine3f, hand::joint_count>;

// What makes the bind pose's palm the wearer's, in the wrist's axes: its breadth, its thickness and
// its length.
Vector3d palm_scale(const hand::HandPose& sized, const hand::HandPose& bind, double thickness) {
  const auto extent = [](const hand::HandPose& pose) {
    const auto head = [&](Joint joint) -> Vector3d {
      return pose[Joint::wrist].inverse() * pose[joint].translation();
    };
    return std::pair{std::abs(head(Joint::index_proximal).x() - head(Joint::little_proximal).x()),
                     std::abs(head(Joint::middle_proximal).z())};
  };
  const auto [breadth, length] = extent(bind);
  const auto [sized_breadth, sized_length] = extent(sized);
  return {sized_breadth / breadth, thickness, sized_length / length};
}

// What makes the bind pose's flesh that of the wearer's bones at the same angles. Nothing turns.
Stretches stretches_to(const hand::HandPose& sized, const hand::HandPose& bind) {
  const double across = length_of_hand(sized) / length_of_hand(bind);
  Stretches stretches;
  for (std::size_t at = 0; at < hand::joint_count; ++at) {
    const auto joint = static_cast<Joint>(at);
    Vector3d scale = Vector3d::Constant(across);
    if (joint == Joint::wrist) scale = palm_scale(sized, bind, across);
    if (const auto end = end_of(joint)) {
      const double before = (bind[*end].translation() - bind[joint].translation()).norm();
      const double now = (sized[*end].translation() - sized[joint].translation()).norm();
      if (before > 0.0) scale.z() = now / before;
    }
    const Eigen::Affine3d stretch = sized[joint] * Eigen::Scaling(scale) * bind[joint].inverse();
    stretches[at] = stretch.cast<float>();
  }
  return stretches;
}

// A movement as a dual quaternion: a rotation, and half of the translation times it.
struct Screw {
  Eigen::Vector4f turn, shift; // x y z w
};
using Screws = std::array<Screw, hand::joint_count>;

// Each has the sign that is nearer to its parent's, so that mixtures go the short way round.
Screws screws_of(const std::array<Eigen::Isometry3d, hand::joint_count>& moves) {
  Screws screws;
  std::array<Eigen::Quaterniond, hand::joint_count> turns;
  for (std::size_t step = 0; step < hand::joint_count; ++step) {
    const std::size_t at = (step + 1) % hand::joint_count;
    Eigen::Quaterniond turn = Eigen::Quaterniond(moves[at].linear()).normalized();
    const auto parent = parent_of(static_cast<Joint>(at));
    if (parent && turn.dot(turns[hand::index_of(*parent)]) < 0.0) turn.coeffs() = -turn.coeffs();
    turns[at] = turn;
    const Vector3d half = 0.5 * moves[at].translation();
    const Eigen::Quaterniond shift = Eigen::Quaterniond(0.0, half.x(), half.y(), half.z()) * turn;
    screws[at] = {turn.coeffs().cast<float>(), shift.coeffs().cast<float>()};
  }
  return screws;
}

Vector3f moved_by(const Screws& screws, const SkinInfluence& influence, const Vector3f& place) {
  Eigen::Vector4f turn = Eigen::Vector4f::Zero();
  Eigen::Vector4f shift = Eigen::Vector4f::Zero();
  for (const auto& [joint, weight] : influence) {
    const Screw& screw = screws[hand::index_of(joint)];
    turn += weight * screw.turn;
    shift += weight * screw.shift;
  }
  const float per_squared = 2.0F / turn.squaredNorm();
  const Vector3f v = turn.head<3>();
  const Vector3f s = shift.head<3>();
  const Vector3f turned = v.cross(v.cross(place) + turn.w() * place);
  const Vector3f shifted = turn.w() * s - shift.w() * v + v.cross(s);
  return place + per_squared * (turned + shifted);
}

Vector3f moved_by(const Stretches& matrices, const SkinInfluence& influence,
                  const Vector3f& place) {
  Vector3f moved = Vector3f::Zero();
  for (const auto& [joint, weight] : influence)
    moved += weight * (matrices[hand::index_of(joint)] * place);
  return moved;
}

using Weights = std::array<float, hand::joint_count>;

// Steps of spreading. Each widens a transition by about the square root of half an edge's square.
constexpr int steps_everywhere = 7;
constexpr int steps_in_palm = 40; // where flesh is thick, and follows farther away

struct Nearest {
  float distance = std::numeric_limits<float>::max();
  const FleshPart* part = nullptr;
};

void seek(const std::vector<FleshPart>& parts, const Vector3f& place, Nearest& nearest) {
  for (const FleshPart& part : parts) {
    const float distance = distance_to(part, place);
    if (distance < nearest.distance) nearest = {distance, &part};
  }
}

void spread(const std::vector<std::vector<std::uint32_t>>& beside, const std::vector<float>& pace,
            std::vector<Weights>& weights) {
  const std::vector<Weights> before = weights;
  for (std::size_t at = 0; at < weights.size(); ++at) {
    if (!(pace[at] > 0.0F) || beside[at].empty()) continue;
    Weights sum{};
    for (const std::uint32_t other : beside[at])
      for (std::size_t joint = 0; joint < sum.size(); ++joint)
        sum[joint] += before[other][joint];
    const float share = 0.5F * pace[at] / static_cast<float>(beside[at].size());
    for (std::size_t joint = 0; joint < sum.size(); ++joint)
      weights[at][joint] = (1.0F - 0.5F * pace[at]) * before[at][joint] + share * sum[joint];
  }
}

// Of the weights of a place, the four strongest.
SkinInfluence strongest(const Weights& weights) {
  std::array<std::size_t, hand::joint_count> order;
  for (std::size_t joint = 0; joint < order.size(); ++joint)
    order[joint] = joint;
  std::partial_sort(order.begin(), order.begin() + 4, order.end(),
                    [&](std::size_t a, std::size_t b) {
                      return weights[a] != weights[b] ? weights[a] > weights[b] : a < b;
                    });
  SkinInfluence influence;
  float sum = 0.0F;
  for (std::size_t rank = 0; rank < influence.size(); ++rank) {
    influence[rank] = {static_cast<Joint>(order[rank]), weights[order[rank]]};
    sum += influence[rank].weight;
  }
  for (JointShare& share : influence)
    share.weight /= sum;
  return influence;
}

// Leaves four joints at each place. To leave others out makes steps; these are evened out again.
void keep_strongest(const std::vector<std::vector<std::uint32_t>>& beside,
                    const std::vector<float>& pace, std::vector<Weights>& weights) {
  for (int round = 0; round < 6; ++round) {
    if (round > 0) spread(beside, pace, weights);
    for (Weights& of_place : weights) {
      const SkinInfluence influence = strongest(of_place);
      of_place.fill(0.0F);
      for (const auto& [joint, weight] : influence)
        of_place[hand::index_of(joint)] = weight;
    }
  }
}

/// Returns the influences on each place of the mesh. At first each is carried by the part of the
/// flesh that is nearest. Then the weights spread along the surface, so that they change smoothly,
/// and never leap from a finger to the next one. Allocates.
std::vector<SkinInfluence> weights_of(const HandFlesh& flesh, const SkinMesh& mesh) {
  std::vector<Weights> weights(mesh.places.size(), Weights{});
  std::vector<float> in_palm(mesh.places.size(), 0.0F);
  for (std::size_t at = 0; at < mesh.places.size(); ++at) {
    Nearest in_finger;
    for (const auto& parts : flesh.fingers())
      seek(parts, mesh.places[at], in_finger);
    Nearest nearest;
    seek(flesh.palm(), mesh.places[at], nearest);
    constexpr float ramp_m = 0.008F;
    in_palm[at] = std::clamp(0.5F + (in_finger.distance - nearest.distance) / ramp_m, 0.0F, 1.0F);
    if (in_finger.distance < nearest.distance) nearest = in_finger;
    const float along = share_along(*nearest.part, mesh.places[at]);
    weights[at][hand::index_of(nearest.part->carriers[0])] += 1.0F - along;
    weights[at][hand::index_of(nearest.part->carriers[1])] += along;
  }
  const auto beside = neighbours_in(mesh);
  for (int step = 0; step < steps_in_palm; ++step)
    spread(beside, in_palm, weights);
  const std::vector<float> everywhere(mesh.places.size(), 1.0F);
  for (int step = 0; step < steps_everywhere; ++step)
    spread(beside, everywhere, weights);
  keep_strongest(beside, everywhere, weights);
  std::vector<SkinInfluence> influences;
  influences.reserve(weights.size());
  for (const Weights& of_place : weights)
    influences.push_back(strongest(of_place));
  return influences;
}

} // namespace

hand::HandPose HandSkin::bind_pose(Side side) {
  return hand::HandSkeleton(side).pose(open_angles(), Eigen::Isometry3d::Identity());
}

// A left hand is the mirror image of a right one.
HandSkin::HandSkin(Side side, float cell_m) : bind_(bind_pose(side)) {
  const HandFlesh flesh(bind_pose(Side::right));
  SkinMesh mesh = net_about(flesh, cell_m);
  influences_ = weights_of(flesh, mesh);
  if (side == Side::left) {
    for (Vector3f& place : mesh.places)
      place.x() = -place.x();
    for (std::size_t at = 0; at < mesh.corners.size(); at += 3)
      std::swap(mesh.corners[at + 1], mesh.corners[at + 2]);
  }
  places_ = std::move(mesh.places);
  corners_ = std::move(mesh.corners);
}

void HandSkin::drape(const hand::HandPose& pose, const Vector3d& origin_m, Surface& surface,
                     Mix mix) const {
  const hand::HandPose sized = with_bones_of(pose, bind_);
  const Stretches stretches = stretches_to(sized, bind_);
  std::array<Eigen::Isometry3d, hand::joint_count> moves;
  Stretches matrices;
  for (std::size_t at = 0; at < hand::joint_count; ++at) {
    moves[at] = Eigen::Translation3d(-origin_m) * pose.joints[at] * sized.joints[at].inverse();
    matrices[at] = Eigen::Affine3d(moves[at]).cast<float>();
  }
  const Screws screws = screws_of(moves);
  surface.places.resize(places_.size());
  for (std::size_t at = 0; at < places_.size(); ++at) {
    const SkinInfluence& influence = influences_[at];
    const Vector3f place = moved_by(stretches, influence, places_[at]);
    surface.places[at] = mix == Mix::screws ? moved_by(screws, influence, place)
                                            : moved_by(matrices, influence, place);
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
    // A tip's place is on the skin, and the last bone ends within it.
    const float length = (place - base).norm();
    const float in_flesh_m = is_tip ? std::min(0.005F, 0.5F * length) : 0.0F;
    const Vector3f end =
        length > 0.0F ? Vector3f(place + in_flesh_m / length * (base - place)) : place;
    add_capsule(surface, base, end, bone_radius_m, bone_radius_m, 8);
  }
}

} // namespace nendo::render
