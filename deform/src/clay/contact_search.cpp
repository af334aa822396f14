#include "clay/contact_search.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace nendo::deform {

using Eigen::Vector3d;

namespace {

std::array<float, 3> as_floats(const Vector3d& vector) noexcept {
  return {static_cast<float>(vector.x()), static_cast<float>(vector.y()),
          static_cast<float>(vector.z())};
}

} // namespace

BoxGate BoxGate::shut() noexcept {
  BoxGate gate;
  gate.limits.sides.fill(-std::numeric_limits<float>::infinity());
  return gate;
}

BoxGate BoxGate::of(const ContactPart& part) noexcept {
  BoxGate gate = shut();
  for (std::size_t at = 0; at < part.corner_count; ++at)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double middle = part.corners[at][static_cast<Eigen::Index>(axis)];
      float& high = gate.limits.sides[axis];
      float& low = gate.limits.sides[axis + 4];
      high = std::max(high, static_cast<float>(middle + part.radii[at]));
      low = std::max(low, static_cast<float>(part.radii[at] - middle));
    }
  gate.limits.sides[3] = gate.limits.sides[7] = std::numeric_limits<float>::infinity();
  return gate;
}

void BoxGate::extend(const BoxGate& other) noexcept {
  for (std::size_t side = 0; side < 8; ++side)
    limits.sides[side] = std::max(limits.sides[side], other.limits.sides[side]);
}

ContactSearch::ContactSearch(std::size_t bodies, std::size_t parts_per_body)
    : bodies_(bodies), parts_per_body_(parts_per_body), parts_(bodies * parts_per_body),
      is_out_(parts_.size(), 0), body_boxes_(bodies, BoxGate::shut()), seen_(parts_per_body),
      lists_(parts_per_body * block_size) {
  cones_.reserve(3 * parts_.size());
  planes_.reserve(parts_.size());
}

void ContactSearch::set_parts(std::span<const ContactPart> parts) noexcept {
  cones_.clear();
  planes_.clear();
  std::fill(body_boxes_.begin(), body_boxes_.end(), BoxGate::shut());
  for (std::size_t at = 0; at < parts_.size(); ++at) {
    const ContactPart& part = parts[at];
    parts_[at] = {static_cast<std::uint32_t>(cones_.size()), 1, no_plane};
    add_cone(part, 0, 1);
    if (part.corner_count == 3) {
      add_cone(part, 1, 2);
      add_cone(part, 2, 0);
      parts_[at].cone_count = 3;
      add_plane(part, parts_[at]);
    }
    body_boxes_[at / parts_per_body_].extend(BoxGate::of(part));
  }
}

void ContactSearch::add_cone(const ContactPart& part, std::size_t first,
                             std::size_t second) noexcept {
  const Vector3d way = part.corners[second] - part.corners[first];
  const double growth = part.radii[second] - part.radii[first];
  const double length = way.norm();
  if (!(length > std::abs(growth))) { // one ball contains the other
    const std::size_t whole = growth > 0.0 ? second : first;
    const auto [x, y, z] = as_floats(part.corners[whole]);
    const auto radius = static_cast<float>(part.radii[whole]);
    cones_.push_back({x, y, z, {}, 0.0F, 0.0F, 0.0F, radius, 0.0F});
    return;
  }
  const double slope = growth / length;
  const auto from = as_floats(part.corners[first]);
  cones_.push_back({from[0], from[1], from[2], as_floats(way), static_cast<float>(length * length),
                    static_cast<float>(1.0 / (length * length)),
                    static_cast<float>(slope / std::sqrt(1.0 - slope * slope) / length),
                    static_cast<float>(part.radii[first]), static_cast<float>(growth)});
}

void ContactSearch::add_plane(const ContactPart& part, PartEntry& entry) noexcept {
  const Vector3d u = part.corners[1] - part.corners[0];
  const Vector3d v = part.corners[2] - part.corners[0];
  const Vector3d across = u.cross(v);
  const double area = across.norm();
  if (!(area > 1e-9 * (u.squaredNorm() + v.squaredNorm()))) return; // its edges are all of it
  const Vector3d normal = across / area;
  const Vector3d first = v.cross(normal) / area;
  const Vector3d second = normal.cross(u) / area;
  const Vector3d slope =
      (part.radii[1] - part.radii[0]) * first + (part.radii[2] - part.radii[0]) * second;
  if (!(slope.squaredNorm() < 1.0)) return; // one ball contains the others
  entry.plane = static_cast<std::uint32_t>(planes_.size());
  const auto from = as_floats(part.corners[0]);
  planes_.push_back({from[0], from[1], from[2], as_floats(normal), as_floats(slope),
                     static_cast<float>(1.0 / std::sqrt(1.0 - slope.squaredNorm())),
                     as_floats(first), as_floats(second), static_cast<float>(part.radii[0])});
}

bool ContactSearch::is_any_near(const BoundedShape& shape, std::span<const BoxGate> boxes,
                                double margin) const noexcept {
  const auto wide = static_cast<float>(margin);
  for (const BlockBounds& bounds : shape.bounds)
    for (const BoxGate& box : boxes)
      if (box.meets(bounds, wide)) return true;
  return false;
}

void ContactSearch::add_box(const BlockBounds& bounds, std::uint32_t block) noexcept {
  const std::size_t at = boxes_.count++;
  const auto& sides = bounds.sides;
  VertexBlock& middles = boxes_.lanes.middles;
  VertexBlock& halves = boxes_.lanes.halves;
  boxes_.blocks[at] = block;
  middles.x[at] = 0.5F * (sides[0] - sides[4]);
  middles.y[at] = 0.5F * (sides[1] - sides[5]);
  middles.z[at] = 0.5F * (sides[2] - sides[6]);
  halves.x[at] = -0.5F * (sides[0] + sides[4]);
  halves.y[at] = -0.5F * (sides[1] + sides[5]);
  halves.z[at] = -0.5F * (sides[2] + sides[6]);
}

void ContactSearch::measure_boxes(std::size_t body, float margin) noexcept {
  for (VertexBlock* const lanes : {&boxes_.lanes.middles, &boxes_.lanes.halves})
    for (std::size_t at = boxes_.count; at < block_size; ++at)
      lanes->x[at] = lanes->y[at] = lanes->z[at] = 0.0F;
  boxes_.nearest.distance.fill(std::numeric_limits<float>::max());
  boxes_.nearest.to_centre.fill(1.0F);
  boxes_.list_sizes.fill(0);
  const auto first = static_cast<std::uint32_t>(body * parts_per_body_);
  for (std::uint32_t part = 0; part < parts_per_body_; ++part)
    if (is_out_[first + part] == 0)
      part_from_boxes(boxes_.lanes, arrays(), first + part, seen_[part], boxes_.nearest);
  for (std::uint32_t part = 0; part < parts_per_body_; ++part)
    if (is_out_[first + part] == 0)
      list_part(first + part, near_in_boxes(boxes_.lanes, seen_[part], boxes_.nearest, margin));
  distances_ += parts_per_body_ * boxes_.count;
}

/// Adds the part to the lists of these boxes, a bit each.
void ContactSearch::list_part(std::uint32_t part, std::uint64_t near) noexcept {
  const std::uint64_t all = ~std::uint64_t{0} >> (block_size - boxes_.count);
  for (std::uint64_t left = near & all; left != 0; left &= left - 1) {
    const auto box = static_cast<std::size_t>(std::countr_zero(left));
    lists_[box * parts_per_body_ + boxes_.list_sizes[box]++] = part;
  }
}

} // namespace nendo::deform
