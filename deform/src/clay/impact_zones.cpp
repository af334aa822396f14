#include "clay/impact_zones.hpp"

#include <algorithm>
#include <cstddef>

namespace nendo::deform {
namespace {

/// Of joining and moving. In the last ones zones stay where they were.
constexpr int max_zone_rounds = 16;
constexpr int still_zone_rounds = 6;
constexpr std::size_t max_members = 2048;

} // namespace

ImpactZones::ImpactZones(const BlockLayout& layout, std::span<const std::uint32_t> triangles)
    : vertices_(layout.vertex_count()), meetings_(layout, triangles), before_(layout.pack()),
      zones_(vertices_), members_(vertices_), moved_(layout.block_count()), wanted_(vertices_),
      ways_(vertices_) {}

std::optional<std::size_t> ImpactZones::keep_apart(BoundedShape& shape, const VolumeKeeper& volume,
                                                   const VertexMask* mask) noexcept {
  members_.clear();
  meetings_.find(shape, before_.shape, volume);
  for (int round = 0; !meetings_.pairs().empty() || meetings_.is_given_up(); ++round) {
    if (round == max_zone_rounds || members_.members().size() > max_members ||
        meetings_.is_given_up()) {
      shape.follow(before_);
      return std::nullopt;
    }
    join_met(shape.shape);
    move(shape.shape, mask, round >= max_zone_rounds - still_zone_rounds);
    meetings_.find_at(members_.members(), shape.shape, before_.shape);
  }
  finish(shape);
  return members_.members().size();
}

/// All corners of two faces that meet become parts of one zone.
void ImpactZones::join_met(const BlockShape& shape) noexcept {
  for (const auto& [one, other] : meetings_.pairs()) {
    const std::uint32_t first = meetings_.corners(one)[0];
    take_in(shape, first);
    for (const FaceMeetings::Triangle triangle : {one, other})
      for (const std::uint32_t corner : meetings_.corners(triangle)) {
        take_in(shape, corner);
        zones_.join(first, corner);
      }
  }
}

void ImpactZones::take_in(const BlockShape& shape, std::uint32_t place) noexcept {
  if (!members_.add(place)) return;
  zones_.reset(place);
  wanted_[place] = vertex_at(shape, place);
}

void ImpactZones::move(BlockShape& shape, const VertexMask* mask, bool stay) noexcept {
  for (const std::uint32_t place : members_.members())
    ways_[place].setZero();
  for (const std::uint32_t place : members_.members()) {
    Eigen::Vector4f& way = ways_[zones_.find(place)];
    way.head<3>() += wanted_[place] - vertex_at(before_.shape, place);
    way[3] += 1.0F;
  }
  for (const std::uint32_t place : members_.members()) {
    const float* const weights = mask == nullptr ? nullptr : mask->of_block(place / block_size);
    if (stay || (weights != nullptr && weights[place % block_size] < 1.0F))
      ways_[zones_.find(place)].head<3>().setZero();
  }
  for (const std::uint32_t place : members_.members()) {
    const Eigen::Vector4f& way = ways_[zones_.find(place)];
    const Eigen::Vector3f to = vertex_at(before_.shape, place) + way.head<3>() / way[3];
    set_vertex(shape.data()[place / block_size], place % block_size, to);
  }
}

void ImpactZones::finish(BoundedShape& shape) noexcept {
  moved_.clear();
  for (const std::uint32_t place : members_.members())
    moved_.add(place / block_size);
  for (const std::size_t block : moved_.members()) {
    VertexBlock& content = shape.shape.data()[block];
    repeat_last(content, std::min(block_size, vertices_ - block * block_size));
    shape.shape.set_stamp(block, BlockShape::new_stamp());
    shape.bounds[block] = bounds_of(content);
  }
}

} // namespace nendo::deform
