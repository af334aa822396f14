#include "render/skin_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <nendo/hand/hand_body.hpp>

namespace nendo::render {

using Eigen::Vector3f;
using Eigen::Vector3i;
using hand::HandPose;
using hand::Joint;
using hand::joint_after;
using hand::metacarpals;

namespace {

constexpr float mm = 0.001F;

// Over which flesh runs together.
constexpr float along_finger_m = 3.5F * mm;
constexpr float in_palm_m = 14 * mm;
constexpr float at_knuckles_m = 10 * mm;
constexpr float at_thumb_m = 14 * mm;
constexpr float between_fingers_m = 6 * mm; // only where they leave the palm
constexpr float at_cut_m = 13 * mm;

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
  for (std::size_t finger = 1; finger < metacarpals.size(); ++finger)
    add_finger(pose, finger);
  prepare(palm_);
  palm_box_ = box_of(palm_);
  for (std::size_t finger = 0; finger < metacarpals.size(); ++finger) {
    prepare(fingers_[finger]);
    finger_boxes_[finger] = box_of(fingers_[finger]);
  }
}

// The bones lie near the back of the hand, and most flesh lies on the side of the palm.
void HandFlesh::add_metacarpals(const HandPose& pose) {
  const Vector3f right = axis_of(pose, Joint::wrist, 0);
  const Vector3f up = axis_of(pose, Joint::wrist, 1);
  const Vector3f back = axis_of(pose, Joint::wrist, 2);
  for (std::size_t finger = 1; finger < metacarpals.size(); ++finger) {
    const Joint root = metacarpals[finger];
    const float head = hand::average_finger_radii[finger].knuckle_mm * mm;
    // Those of index and middle finger are fixed to the wrist.
    const Joint carrier = finger < 3 ? Joint::wrist : root;
    palm_.push_back(round_part(place_of(pose, root) - 4.5F * mm * up,
                               place_of(pose, joint_after(root, 1)) - 2 * mm * up, 10 * mm, head,
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
  for (std::size_t finger = 1; finger + 1 < metacarpals.size(); ++finger) {
    const auto beside = [&](std::size_t which) -> Vector3f {
      const Joint proximal = joint_after(metacarpals[which], 1);
      return between(place_of(pose, proximal), place_of(pose, joint_after(proximal, 1)), 0.34F) -
             2.5F * mm * axis_of(pose, proximal, 1);
    };
    palm_.push_back(
        round_part(beside(finger), beside(finger + 1), 5 * mm, 5 * mm, 10 * mm,
                   {joint_after(metacarpals[finger], 1), joint_after(metacarpals[finger + 1], 1)}));
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
  const auto at = [&](std::size_t step) {
    return place_of(pose, joint_after(metacarpals[0], step));
  };
  const auto carried = [](std::size_t step) {
    return std::array{joint_after(metacarpals[0], step), joint_after(metacarpals[0], step)};
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
    const Joint joint = joint_after(metacarpals[finger], bone + 1);
    const Vector3f up = axis_of(pose, joint, 1);
    const Vector3f from = place_of(pose, joint) - 1 * mm * up;
    const Vector3f to = place_of(pose, joint_after(joint, 1)) - 1 * mm * up;
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

namespace {

constexpr int block_cells = 5;
constexpr int rounds = 3; // of evening out

// Of a cell: its corners, as bits, that are inside. Returns whether these hang together by the
// cell's edges.
bool hangs_together(unsigned corners) noexcept {
  unsigned found = corners & (0U - corners); // the first of them
  for (unsigned before = 0; before != found;) {
    before = found;
    // Neighbours along x, y and z.
    found |= (before & 0x55U) << 1U | (before & 0xAAU) >> 1U;
    found |= (before & 0x33U) << 2U | (before & 0xCCU) >> 2U;
    found |= (before & 0x0FU) << 4U | (before & 0xF0U) >> 4U;
    found &= corners;
  }
  return found == corners;
}

// Surface nets (S. Gibson, "Constrained elastic surface nets", MICCAI 1998): a vertex in each cell
// that the surface passes through, amid its crossings of the cell's edges; a quad for each edge.
class Net {
public:
  Net(const HandFlesh& flesh, float cell_m)
      : lowest_(flesh.box().min()), cell_m_(cell_m),
        count_((flesh.box().sizes() / cell_m).cast<int>() + Vector3i::Constant(2)) {
    values_.resize(static_cast<std::size_t>(count_.x()) * static_cast<std::size_t>(count_.y()) *
                   static_cast<std::size_t>(count_.z()));
    for (Vector3i first = Vector3i::Zero(); first.z() < count_.z(); first.z() += block_cells)
      for (first.y() = 0; first.y() < count_.y(); first.y() += block_cells)
        for (first.x() = 0; first.x() < count_.x(); first.x() += block_cells)
          fill_block(flesh, first);
    while (open_pinches()) {
    }
  }

  SkinMesh mesh() {
    for (int z = 0; z < count_.z(); ++z)
      for (int y = 0; y < count_.y(); ++y)
        for (int x = 0; x < count_.x(); ++x)
          for (int axis = 0; axis < 3; ++axis)
            add_quad(Vector3i(x, y, z), axis);
    return std::move(mesh_);
  }

private:
  // Most blocks are so far from the surface that one distance decides for them.
  void fill_block(const HandFlesh& flesh, const Vector3i& first) {
    const Vector3i end = (first + Vector3i::Constant(block_cells)).cwiseMin(count_);
    const Vector3f half = 0.5F * cell_m_ * (end - first).cast<float>();
    const float middle = flesh(place(first) + half);
    const bool is_far = std::abs(middle) > HandFlesh::steepness * half.norm() + HandFlesh::slack_m;
    for (int z = first.z(); z < end.z(); ++z)
      for (int y = first.y(); y < end.y(); ++y)
        for (int x = first.x(); x < end.x(); ++x) {
          const Vector3i at(x, y, z);
          values_[index(at)] = is_far ? middle : flesh(place(at));
        }
  }
  // Where two sheets of the surface pass through one cell, they would share its vertex and perhaps
  // an edge. There, the corner that is least inside is put outside. Returns whether there was any.
  bool open_pinches() {
    bool any = false;
    for (int z = 0; z + 1 < count_.z(); ++z)
      for (int y = 0; y + 1 < count_.y(); ++y)
        for (int x = 0; x + 1 < count_.x(); ++x)
          any = open_pinch(Vector3i(x, y, z)) || any;
    return any;
  }
  bool open_pinch(const Vector3i& at) {
    unsigned inside = 0;
    std::size_t least = 0;
    float deepest = std::numeric_limits<float>::lowest();
    for (unsigned corner = 0; corner < 8; ++corner) {
      const std::size_t here =
          index(at + Vector3i(int(corner & 1U), int(corner >> 1U & 1U), int(corner >> 2U & 1U)));
      if (!(values_[here] < 0.0F)) continue;
      inside |= 1U << corner;
      if (values_[here] > deepest) {
        deepest = values_[here];
        least = here;
      }
    }
    if (inside == 0 || inside == 0xFFU) return false;
    if (hangs_together(inside) && hangs_together(~inside & 0xFFU)) return false;
    values_[least] = -values_[least];
    return true;
  }
  std::size_t index(const Vector3i& at) const noexcept {
    const std::ptrdiff_t row = std::ptrdiff_t{at.z()} * count_.y() + at.y();
    return static_cast<std::size_t>(row * count_.x() + at.x());
  }
  Vector3f place(const Vector3i& at) const { return lowest_ + cell_m_ * at.cast<float>(); }

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
    const auto length = [&](std::size_t a, std::size_t b) {
      return (mesh_.places[quad[a]] - mesh_.places[quad[b]]).squaredNorm();
    };
    if (length(0, 2) > length(1, 3)) std::rotate(quad.begin(), quad.begin() + 1, quad.end());
    mesh_.corners.insert(mesh_.corners.end(),
                         {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]});
  }

  Vector3f lowest_;
  float cell_m_;
  Vector3i count_;
  std::vector<float> values_;
  std::unordered_map<std::size_t, std::uint32_t> vertices_;
  SkinMesh mesh_;
};

// Newton's step to the zero of the distance, by differences at a tetrahedron's corners. Where
// fingers meet the slope has a jump, and a step could be long.
Vector3f onto_surface(const HandFlesh& flesh, const Vector3f& place, float cell_m) {
  constexpr std::array<std::array<float, 3>, 4> corners{
      {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
  const float step = 0.05F * cell_m;
  Vector3f slope = Vector3f::Zero();
  float middle = 0.0F;
  for (const auto& corner : corners) {
    const Vector3f way(corner[0], corner[1], corner[2]);
    const float value = flesh(place + step * way);
    slope += value * way;
    middle += 0.25F * value;
  }
  slope /= 4.0F * step;
  const float squared = slope.squaredNorm();
  if (!(squared > 0.05F)) return place;
  const float longest = 0.3F * cell_m;
  Vector3f move = -middle / squared * slope;
  const float length = move.norm();
  if (length > longest) move *= longest / length;
  return place + move;
}

} // namespace

std::vector<std::vector<std::uint32_t>> neighbours_in(const SkinMesh& mesh) {
  std::vector<std::vector<std::uint32_t>> beside(mesh.places.size());
  // Each edge of a closed surface has two triangles, which run along it in opposite directions.
  for (std::size_t at = 0; at < mesh.corners.size(); at += 3)
    for (std::size_t k = 0; k < 3; ++k)
      beside[mesh.corners[at + k]].push_back(mesh.corners[at + (k + 1) % 3]);
  return beside;
}

SkinMesh net_about(const HandFlesh& flesh, float cell_m) {
  SkinMesh mesh = Net(flesh, cell_m).mesh();
  const auto beside = neighbours_in(mesh);
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vector3f> moved(mesh.places.size());
    for (std::size_t at = 0; at < moved.size(); ++at) {
      Vector3f sum = Vector3f::Zero();
      for (const std::uint32_t other : beside[at])
        sum += mesh.places[other];
      const Vector3f mean = sum / static_cast<float>(std::max<std::size_t>(1, beside[at].size()));
      moved[at] = onto_surface(flesh, 0.5F * (mesh.places[at] + mean), cell_m);
    }
    mesh.places = std::move(moved);
  }
  return mesh;
}

} // namespace nendo::render
