#include "clay/impact_zones.hpp"

#include <algorithm>
#include <cstddef>

namespace nendo::deform {
namespace {

/// Of joining and moving. In the last ones zones stay where they were.
constexpr int most_zone_rounds = 16;
constexpr int still_zone_rounds = 6;
constexpr std::size_t most_members = 2048;

} // namespace

ImpactZones::ImpactZones(const BlockLayout& layout, std::span<const std::uint32_t> triangles)
    : vertices_(layout.vertex_count()), meetings_(layout, triangles) {
  if (triangles.empty()) return;
  before_ = layout.pack();
  zones_.resize(vertices_);
  members_ = Marks(vertices_);
  wanted_.resize(vertices_);
  ways_.resize(vertices_);
}

std::optional<std::size_t> ImpactZones::keep_apart(BoundedShape& shape, const VolumeKeeper& volume,
                                                   const VertexMask* mask) noexcept {
  members_.clear();
  meetings_.find(shape, before_, volume);
  for (int round = 0; !meetings_.pairs().empty() || meetings_.is_given_up(); ++round) {
    if (round == most_zone_rounds || members_.members().size() > most_members ||
        meetings_.is_given_up()) {
      take_back(shape);
      return std::nullopt;
    }
    join_met(shape.shape);
    move(shape.shape, mask, round >= most_zone_rounds - still_zone_rounds);
    meetings_.find_at(members_.members(), shape.shape, before_);
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
        const std::uint32_t head = zone_of(first);
        zones_[zone_of(corner)] = head;
      }
  }
}

void ImpactZones::take_in(const BlockShape& shape, std::uint32_t place) noexcept {
  if (!members_.add(place)) return;
  zones_[place] = place;
  wanted_[place] = vertex_at(shape, place);
}

std::uint32_t ImpactZones::zone_of(std::uint32_t place) noexcept {
  while (zones_[place] != place) {
    zones_[place] = zones_[zones_[place]];
    place = zones_[place];
  }
  return place;
}

void ImpactZones::move(BlockShape& shape, const VertexMask* mask, bool stay) noexcept {
  for (const std::uint32_t place : members_.members())
    ways_[place].setZero();
  for (const std::uint32_t place : members_.members()) {
    Eigen::Vector4f& way = ways_[zone_of(place)];
    way.head<3>() += wanted_[place] - vertex_at(before_, place);
    way[3] += 1.0F;
  }
  for (const std::uint32_t place : members_.members()) {
    const float* const weights = mask == nullptr ? nullptr : mask->of_block(place / block_size);
    if (stay || (weights != nullptr && weights[place % block_size] < 1.0F))
      ways_[zone_of(place)].head<3>().setZero();
  }
  for (const std::uint32_t place : members_.members()) {
    const Eigen::Vector4f& way = ways_[zone_of(place)];
    const Eigen::Vector3f to = vertex_at(before_, place) + way.head<3>() / way[3];
    VertexBlock& block = shape.data()[place / block_size];
    block.x[place % block_size] = to.x();
    block.y[place % block_size] = to.y();
    block.z[place % block_size] = to.z();
  }
}

void ImpactZones::finish(BoundedShape& shape) const noexcept {
  for (const std::uint32_t place : members_.members()) {
    const std::uint32_t block = place / block_size;
    VertexBlock& content = shape.shape.data()[block];
    const std::size_t used = std::min(block_size, vertices_ - block * block_size);
    for (std::size_t lane = used; lane < block_size; ++lane) { // the padding repeats the last one
      content.x[lane] = content.x[used - 1];
      content.y[lane] = content.y[used - 1];
      content.z[lane] = content.z[used - 1];
    }
    shape.shape.set_stamp(block, BlockShape::new_stamp());
    shape.bounds[block] = bounds_of(content);
  }
}

void ImpactZones::take_back(BoundedShape& shape) const noexcept {
  for (std::size_t block = 0; block < shape.bounds.size(); ++block) {
    if (shape.shape.stamp(block) == before_.stamp(block)) continue;
    shape.shape.data()[block] = before_[block];
    shape.shape.set_stamp(block, before_.stamp(block));
    shape.bounds[block] = bounds_of(before_[block]);
  }
}

} // namespace nendo::deform
