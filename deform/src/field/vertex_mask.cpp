// A mask of vertices, and steps of which it undoes a part (masked_step.hpp).

#include <nendo/deform/vertex_mask.hpp>

#include <algorithm>
#include <cassert>
#include <utility>

#include "field/masked_step.hpp"

namespace nendo::deform {

namespace {

/// The ends are exact: no sum rounds what does not move, or what is free.
void scale_axis(const std::array<float, block_size>& weights,
                const std::array<float, block_size>& from,
                std::array<float, block_size>& to) noexcept {
  for (std::size_t lane = 0; lane < block_size; ++lane) {
    const float weight = weights[lane];
    const float part = from[lane] + weight * (to[lane] - from[lane]);
    to[lane] = weight <= 0.0F ? from[lane] : weight >= 1.0F ? to[lane] : part;
  }
}

/// Scales the displacement of the block `to` from `from` by the weights of `part`.
void scale_block(const VertexMask::Part& part, const VertexBlock& from, VertexBlock& to) noexcept {
  scale_axis(part.weights, from.x, to.x);
  scale_axis(part.weights, from.y, to.y);
  scale_axis(part.weights, from.z, to.z);
}

} // namespace

VertexMask::VertexMask(const BlockLayout& layout, const Eigen::VectorXd& weights)
    : numbers_(layout.block_count(), no_index) {
  const auto& order = layout.order();
  assert(weights.size() == static_cast<Eigen::Index>(order.size()));
  for (std::size_t block = 0; block < numbers_.size(); ++block) {
    Part part{static_cast<std::uint32_t>(block)};
    for (std::size_t lane = 0; lane < block_size; ++lane) {
      // The rest of the last block repeats its last vertex.
      const std::size_t place = std::min(block * block_size + lane, order.size() - 1);
      part.weights[lane] = static_cast<float>(std::clamp(weights[order[place]], 0.0, 1.0));
    }
    const auto [least, most] = std::minmax_element(part.weights.begin(), part.weights.end());
    if (*least >= 1.0F) continue;
    part.is_still = *most <= 0.0F;
    numbers_[block] = static_cast<std::uint32_t>(parts_.size());
    parts_.push_back(part);
  }
}

void VertexMask::apply(const BlockShape& from, BlockShape& to) const noexcept {
  for (const Part& part : parts_) {
    if (part.is_still)
      to.follow(from, part.block);
    else if (to.stamp(part.block) != from.stamp(part.block))
      scale_block(part, from[part.block], to.data()[part.block]);
  }
}

MaskedStep::MaskedStep(std::shared_ptr<const VertexMask> mask) : mask_(std::move(mask)) {
  if (!mask_) return;
  kept_.resize(mask_->parts().size());
  stamps_.resize(kept_.size());
}

void MaskedStep::begin(const BlockShape& shape) noexcept {
  for (std::size_t at = 0; at < kept_.size(); ++at) {
    const std::uint32_t block = mask_->parts()[at].block;
    kept_[at] = shape[block];
    stamps_[at] = shape.stamp(block);
  }
}

void MaskedStep::end(BoundedShape& shape) const noexcept {
  for (std::size_t at = 0; at < kept_.size(); ++at) {
    const VertexMask::Part& part = mask_->parts()[at];
    if (shape.shape.stamp(part.block) == stamps_[at]) continue;
    VertexBlock& block = shape.shape.data()[part.block];
    scale_block(part, kept_[at], block);
    if (part.is_still) shape.shape.set_stamp(part.block, stamps_[at]);
    shape.bounds[part.block] = bounds_of(block);
  }
}

} // namespace nendo::deform
