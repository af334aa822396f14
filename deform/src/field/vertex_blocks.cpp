#include <nendo/deform/vertex_blocks.hpp>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <utility>

#include "field/block_order.hpp"

namespace nendo::deform {

BlockBounds bounds_of(const VertexBlock& block) noexcept {
  const auto [low_x, high_x] = std::minmax_element(block.x.begin(), block.x.end());
  const auto [low_y, high_y] = std::minmax_element(block.y.begin(), block.y.end());
  const auto [low_z, high_z] = std::minmax_element(block.z.begin(), block.z.end());
  return {{*low_x, *low_y, *low_z, 0.0F, -*high_x, -*high_y, -*high_z, 0.0F}};
}

BlockShape::BlockShape(std::vector<VertexBlock> blocks)
    : blocks_(std::move(blocks)), stamps_(blocks_.size(), new_stamp()) {}

std::uint64_t BlockShape::new_stamp() noexcept {
  static std::atomic<std::uint64_t> last{0};
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

void BlockShape::follow(const BlockShape& other) {
  if (block_count() != other.block_count()) {
    *this = other;
    return;
  }
  for (std::size_t block = 0; block < block_count(); ++block)
    follow(other, block);
}

BlockLayout::BlockLayout(Points vertices)
    : original_(std::move(vertices)), diagonal_(diagonal_of(original_)),
      order_(block_order(original_)) {
  const auto [lowest, highest] = finite_box_of(original_);
  if (!(lowest[0] <= highest[0])) return;
  origin_ = lowest / 2.0 + highest / 2.0;
  const double half = (highest / 2.0 - lowest / 2.0).maxCoeff();
  // 2^-1000: where dividing by the unit would overflow.
  if (half > 0.0) unit_ = std::ldexp(1.0, std::clamp(std::ilogb(half) + 1, -1000, 1023));
}

/// A coordinate that is not finite stands still in the middle, where it harms no bounds.
float BlockLayout::packed(double coordinate, Eigen::Index axis) const noexcept {
  return std::isfinite(coordinate) ? static_cast<float>((coordinate - origin_[axis]) / unit_)
                                   : 0.0F;
}

namespace {

/// `column_of(vertex)` gives three floats.
template <class ColumnOf>
BlockShape filled(const std::vector<std::uint32_t>& order, std::size_t block_count,
                  const ColumnOf& column_of) {
  std::vector<VertexBlock> blocks(block_count);
  for (std::size_t at = 0; at < block_count * block_size; ++at) {
    const std::uint32_t vertex = order[std::min(at, order.size() - 1)];
    const Eigen::Vector3f column = column_of(static_cast<Eigen::Index>(vertex));
    VertexBlock& block = blocks[at / block_size];
    block.x[at % block_size] = column[0];
    block.y[at % block_size] = column[1];
    block.z[at % block_size] = column[2];
  }
  return BlockShape(std::move(blocks));
}

} // namespace

std::vector<std::uint32_t> BlockLayout::places() const {
  std::vector<std::uint32_t> places(vertex_count());
  for (std::size_t at = 0; at < places.size(); ++at)
    places[order_[at]] = static_cast<std::uint32_t>(at);
  return places;
}

BlockShape BlockLayout::pack(const Points& places) const {
  assert(places.cols() == original_.cols());
  return filled(order_, block_count(), [&](Eigen::Index vertex) -> Eigen::Vector3f {
    const auto column = places.col(vertex);
    return {packed(column[0], 0), packed(column[1], 1), packed(column[2], 2)};
  });
}

void BlockLayout::unpack(const BlockShape& shape, Points& out) const {
  assert(shape.block_count() == block_count());
  if (out.cols() != original_.cols()) out.resize(3, original_.cols());
  for (std::size_t at = 0; at < order_.size(); ++at) {
    const auto vertex = static_cast<Eigen::Index>(order_[at]);
    const Eigen::Vector3f place = vertex_at(shape, at);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double before = original_(axis, vertex);
      out(axis, vertex) = place[axis] == packed(before, axis)
                              ? before
                              : origin_[axis] + unit_ * static_cast<double>(place[axis]);
    }
  }
}

Eigen::Vector3d BlockLayout::rounded(const Eigen::Vector3d& place) const noexcept {
  Eigen::Vector3d result = place;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double coordinate = (place[axis] - origin_[axis]) / unit_;
    if (std::abs(coordinate) <= max_units)
      result[axis] = origin_[axis] + unit_ * static_cast<double>(static_cast<float>(coordinate));
  }
  return result;
}

double BlockLayout::rounded_radius(double radius) const noexcept {
  const double inverse = unit_ / radius;
  const bool fits = inverse <= max_units && inverse >= 1.0 / max_units; // false for NaN
  return fits ? unit_ / static_cast<double>(static_cast<float>(inverse)) : radius;
}

} // namespace nendo::deform
