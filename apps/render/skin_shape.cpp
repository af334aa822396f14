#include "render/skin_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace nendo::render {

using Eigen::Vector3f;
using Eigen::Vector3i;
using hand::Joint;

namespace {

constexpr float cell_m = 0.003F;
constexpr float forearm_m = 0.05F;       // of it, what is shown
constexpr float forearm_half_m = 0.016F; // between its two bones, half of that
constexpr float along_finger_m = 0.005F; // over which flesh runs together
constexpr float in_palm_m = 0.020F;
constexpr float at_knuckles_m = 0.008F;

// The lesser of two distances, rounded where they are within `soft` of each other.
float soft_min(float a, float b, float soft) noexcept {
  const float h = std::max(0.0F, soft - std::abs(a - b)) / soft;
  return std::min(a, b) - 0.25F * h * h * soft;
}

float flesh(const std::array<BoneLine, skin_bones>& lines, const Vector3f& place) {
  const auto& bones = fleshed_bones();
  float palm = std::numeric_limits<float>::max();
  for (std::size_t bone = 0; bone < palm_bones; ++bone)
    palm = soft_min(palm, distance_to(bones[bone], lines[bone], place), in_palm_m);
  float whole = palm;
  for (std::size_t bone = palm_bones; bone < skin_bones;) {
    float finger = std::numeric_limits<float>::max();
    do {
      finger = soft_min(finger, distance_to(bones[bone], lines[bone], place), along_finger_m);
    } while (++bone < skin_bones && bones[bone].joint == bones[bone - 1].end);
    whole = std::min(whole, soft_min(finger, palm, at_knuckles_m));
  }
  return whole;
}

// Surface nets (S. Gibson, "Constrained elastic surface nets", MICCAI 1998): a vertex in each cell
// that the surface passes through, amid its crossings of the cell's edges; a quad for each edge.
class Net {
public:
  Net(const std::array<BoneLine, skin_bones>& lines, const Vector3f& lowest,
      const Vector3f& highest)
      : lowest_(lowest), count_(((highest - lowest) / cell_m).cast<int>() + Vector3i::Constant(2)) {
    values_.resize(static_cast<std::size_t>(count_.x()) * static_cast<std::size_t>(count_.y()) *
                   static_cast<std::size_t>(count_.z()));
    each([&](const Vector3i& at) { values_[index(at)] = flesh(lines, place(at)); });
  }

  SkinMesh mesh() {
    each([&](const Vector3i& at) {
      for (int axis = 0; axis < 3; ++axis)
        add_quad(at, axis);
    });
    return std::move(mesh_);
  }

private:
  template <class Visit>
  void each(Visit visit) const {
    for (int z = 0; z < count_.z(); ++z)
      for (int y = 0; y < count_.y(); ++y)
        for (int x = 0; x < count_.x(); ++x)
          visit(Vector3i(x, y, z));
  }
  std::size_t index(const Vector3i& at) const noexcept {
    return static_cast<std::size_t>((at.z() * count_.y() + at.y()) * count_.x() + at.x());
  }
  Vector3f place(const Vector3i& at) const { return lowest_ + cell_m * at.cast<float>(); }

  // Of the cell whose lowest corner is `at`.
  std::uint32_t vertex(const Vector3i& at) {
    const auto [entry, is_new] =
        vertices_.try_emplace(index(at), static_cast<std::uint32_t>(mesh_.places.size()));
    if (!is_new) return entry->second;
    Vector3f sum = Vector3f::Zero();
    int crossings = 0;
    for (int corner = 0; corner < 8; ++corner)
      for (int axis = 0; axis < 3; ++axis) {
        if ((corner >> axis & 1) != 0) continue;
        const Vector3i a = at + Vector3i(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
        const Vector3i b = a + Vector3i::Unit(axis);
        const float from = values_[index(a)];
        const float to = values_[index(b)];
        if ((from < 0.0F) == (to < 0.0F)) continue;
        sum += place(a) + from / (from - to) * (place(b) - place(a));
        ++crossings;
      }
    mesh_.places.emplace_back(sum / static_cast<float>(std::max(1, crossings)));
    return entry->second;
  }

  // About the edge from `at` along `axis`, if the surface crosses it.
  void add_quad(const Vector3i& at, int axis) {
    const Vector3i u = Vector3i::Unit((axis + 1) % 3);
    const Vector3i v = Vector3i::Unit((axis + 2) % 3);
    if (at.dot(u) == 0 || at.dot(v) == 0 || at[axis] + 1 >= count_[axis]) return;
    const bool inside = values_[index(at)] < 0.0F;
    if (inside == (values_[index(at + Vector3i::Unit(axis))] < 0.0F)) return;
    std::array<std::uint32_t, 4> quad{vertex(at - u - v), vertex(at - v), vertex(at),
                                      vertex(at - u)};
    if (!inside) std::reverse(quad.begin(), quad.end());
    mesh_.corners.insert(mesh_.corners.end(),
                         {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]});
  }

  Vector3f lowest_;
  Vector3i count_;
  std::vector<float> values_;
  std::unordered_map<std::size_t, std::uint32_t> vertices_;
  SkinMesh mesh_;
};

} // namespace

// Thicknesses between those of ANSUR II's women and men where it has them (breadths of fingers'
// joints), and otherwise by eye.
const std::array<FleshedBone, skin_bones>& fleshed_bones() noexcept {
  static constexpr std::array<FleshedBone, skin_bones> bones{{
      {Joint::wrist, Joint::wrist, 0.0170F, 0.0180F},
      {Joint::thumb_metacarpal, Joint::thumb_proximal, 0.0150F, 0.0125F},
      {Joint::index_metacarpal, Joint::index_proximal, 0.0135F, 0.0110F},
      {Joint::middle_metacarpal, Joint::middle_proximal, 0.0140F, 0.0110F},
      {Joint::ring_metacarpal, Joint::ring_proximal, 0.0140F, 0.0105F},
      {Joint::little_metacarpal, Joint::little_proximal, 0.0135F, 0.0100F},
      {Joint::thumb_proximal, Joint::thumb_distal, 0.0115F, 0.0105F},
      {Joint::thumb_distal, Joint::thumb_tip, 0.0105F, 0.0080F},
      {Joint::index_proximal, Joint::index_intermediate, 0.0102F, 0.0088F},
      {Joint::index_intermediate, Joint::index_distal, 0.0088F, 0.0078F},
      {Joint::index_distal, Joint::index_tip, 0.0078F, 0.0064F},
      {Joint::middle_proximal, Joint::middle_intermediate, 0.0102F, 0.0090F},
      {Joint::middle_intermediate, Joint::middle_distal, 0.0090F, 0.0080F},
      {Joint::middle_distal, Joint::middle_tip, 0.0080F, 0.0066F},
      {Joint::ring_proximal, Joint::ring_intermediate, 0.0098F, 0.0085F},
      {Joint::ring_intermediate, Joint::ring_distal, 0.0085F, 0.0075F},
      {Joint::ring_distal, Joint::ring_tip, 0.0075F, 0.0062F},
      {Joint::little_proximal, Joint::little_intermediate, 0.0088F, 0.0075F},
      {Joint::little_intermediate, Joint::little_distal, 0.0075F, 0.0067F},
      {Joint::little_distal, Joint::little_tip, 0.0067F, 0.0055F},
  }};
  return bones;
}

std::array<BoneLine, skin_bones> bone_lines(const hand::HandPose& pose) {
  std::array<BoneLine, skin_bones> lines;
  for (std::size_t bone = 0; bone < skin_bones; ++bone) {
    const FleshedBone& fleshed = fleshed_bones()[bone];
    const auto& T_world_joint = pose[fleshed.joint];
    const Eigen::Vector3d end =
        fleshed.end == fleshed.joint
            ? Eigen::Vector3d(T_world_joint *
                              Eigen::Vector3d(0.0, 0.0, static_cast<double>(forearm_m)))
            : Eigen::Vector3d(pose[fleshed.end].translation());
    lines[bone] = {T_world_joint.translation().cast<float>(), end.cast<float>()};
  }
  return lines;
}

float distance_to(const FleshedBone& bone, const BoneLine& line, const Vector3f& place) {
  const bool is_tip = bone.end == Joint::thumb_tip || bone.end == Joint::index_tip ||
                      bone.end == Joint::middle_tip || bone.end == Joint::ring_tip ||
                      bone.end == Joint::little_tip;
  Vector3f way = line.to - line.from;
  const float length = way.norm();
  // A tip is where the finger's flesh ends.
  if (is_tip && length > bone.end_radius_m) way *= (length - bone.end_radius_m) / length;
  const Vector3f from = place - line.from;
  const float squared = way.squaredNorm();
  const float t = squared > 0.0F ? std::clamp(from.dot(way) / squared, 0.0F, 1.0F) : 0.0F;
  Vector3f away = from - t * way;
  if (bone.joint == bone.end) // two bones beside each other: an oval
    away.x() = std::copysign(std::max(0.0F, std::abs(away.x()) - forearm_half_m), away.x());
  return away.norm() - (bone.radius_m + t * (bone.end_radius_m - bone.radius_m));
}

SkinMesh skin_about(const std::array<BoneLine, skin_bones>& lines) {
  Vector3f lowest = lines[0].from;
  Vector3f highest = lowest;
  for (const auto& line : lines) {
    lowest = lowest.cwiseMin(line.from).cwiseMin(line.to);
    highest = highest.cwiseMax(line.from).cwiseMax(line.to);
  }
  const Vector3f room = Vector3f::Constant(0.04F);
  return Net(lines, lowest - room, highest + room).mesh();
}

} // namespace nendo::render
