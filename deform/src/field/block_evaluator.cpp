#include "field/block_evaluator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "field/evaluator_parts.hpp"
#include "simd/field_kernels.hpp"

namespace nendo::deform {

namespace {

constexpr std::size_t min_shared = 3; // pieces

double extent_of(const std::vector<BlockBounds>& bounds) noexcept {
  float extent = 0.0F;
  for (const auto& box : bounds)
    for (const float side : box.sides)
      extent = std::max(extent, std::abs(side));
  return static_cast<double>(extent);
}

} // namespace

BoundedShape::BoundedShape(BlockShape blocks) : shape(std::move(blocks)) {
  for (std::size_t block = 0; block < shape.block_count(); ++block)
    bounds.push_back(bounds_of(shape[block]));
  extent = extent_of(bounds);
}

void BoundedShape::follow(const BoundedShape& other) {
  shape.follow(other.shape);
  bounds = other.bounds;
  extent = other.extent;
}

void ListArrays::reserve(std::size_t entries) {
  if (lists_ != nullptr && entries <= entries_) return;
  entries_ = entries;
  lists_ = hwy::AllocateAligned<std::uint32_t>(group_size * padded_list_size(entries));
  for (auto& array : names_)
    array = hwy::AllocateAligned<std::uint32_t>(padded_list_size(entries));
  for (auto& array : numbers_)
    array = hwy::AllocateAligned<float>(padded_list_size(entries));
}

BlockEvaluator::Parts::Parts(const BlockLayout& layout, Eigen::Index entries, int threads)
    : field(layout, entries), reached(layout.block_count(), 0) {
  if (threads > 1) worker.emplace();
  for (auto& list : lists)
    list.reserve(static_cast<std::size_t>(entries));
}

BlockEvaluator::BlockEvaluator(const BlockLayout& layout, Eigen::Index entries,
                               const EvaluationOptions& options)
    : parts_(std::make_unique<Parts>(layout, entries, options.threads)) {}
BlockEvaluator::~BlockEvaluator() = default;

bool BlockEvaluator::set_field(const CsrbfField& field) noexcept {
  for (auto& list : parts_->lists)
    list.reserve(static_cast<std::size_t>(field.centres.cols()));
  parts_->is_halfway = field.is_halfway;
  return parts_->field.assign(field, BlockField::Zeros::left_out);
}

void BlockEvaluator::reserve_halves(const BlockLayout& layout) {
  parts_->places.emplace(layout.pack());
}

bool BlockEvaluator::fits(const BoundedShape& shape) const noexcept {
  return shape.extent + parts_->field.bound(shape.extent) <= max_units;
}

namespace {

/// Over all blocks; `to` may be null.
BlockPass pass_over(const BoundedShape& from, VertexBlock* to,
                    BlockEvaluator::Parts& parts) noexcept {
  const std::size_t blocks = from.shape.block_count();
  return {.from = from.shape.data(),
          .to = to,
          .bounds = from.bounds.data(),
          .reached = parts.reached.data(),
          .begin = 0,
          .end = blocks,
          .scratch = parts.lists[0].scratch(),
          .large = leaves_caches(from.shape)};
}

/// In pieces; calls after(block, reached) for each block.
template <class After>
void run(const BlockPass& whole, BlockEvaluator::Parts& parts, const After& after) noexcept {
  parts.in_pieces(whole.end, min_shared,
                  [&](std::size_t begin, std::size_t end, std::size_t thread) {
                    BlockPass piece = whole;
                    piece.begin = begin;
                    piece.end = end;
                    piece.scratch = parts.lists[thread].scratch();
                    displace_pass(parts.field.view(), piece);
                    for (std::size_t block = begin; block < end; ++block)
                      after(block, parts.reached[block] > 0);
                  });
}

} // namespace

bool BlockEvaluator::displace(const BoundedShape& from, BlockShape& to) noexcept {
  if (to.block_count() != from.shape.block_count()) to = from.shape;
  if (!fits(from)) {
    to.follow(from.shape);
    return false;
  }
  const std::uint64_t stamp = BlockShape::new_stamp();
  const BlockPass pass = pass_over(from, to.data(), *parts_);
  run(pass, *parts_, [&](std::size_t block, bool reached) {
    reached ? to.set_stamp(block, stamp) : to.follow(from.shape, block);
  });
  return true;
}

/// Bounds on bounds grow with each step: measured before they are believed.
bool BlockEvaluator::fits_measured(BoundedShape& shape) const noexcept {
  if (!fits(shape)) shape.extent = extent_of(shape.bounds);
  return fits(shape);
}

bool BlockEvaluator::displace(BoundedShape& shape) noexcept {
  const bool is_halfway = parts_->is_halfway;
  // The second field of a midpoint step is evaluated where the first one has led.
  const bool is_second = std::exchange(parts_->has_places, false) && !is_halfway;
  if (!fits_measured(shape)) return false;
  BoundedShape& to = is_halfway ? *parts_->places : shape;
  const std::uint64_t stamp = BlockShape::new_stamp();
  BlockPass pass = pass_over(is_second ? *parts_->places : shape, to.shape.data(), *parts_);
  if (is_second) pass.base = shape.shape.data();
  pass.new_bounds = to.bounds.data();
  run(pass, *parts_, [&](std::size_t block, bool reached) {
    if (reached) {
      to.shape.set_stamp(block, stamp);
    } else if (is_halfway) {
      to.shape.follow(shape.shape, block);
      to.bounds[block] = shape.bounds[block];
    }
  });
  to.extent = shape.extent + parts_->field.bound(shape.extent);
  parts_->has_places = is_halfway;
  return true;
}

std::size_t BlockEvaluator::count_pairs(const BoundedShape& shape) noexcept {
  return deform::count_pairs(parts_->field.view(), pass_over(shape, nullptr, *parts_));
}

} // namespace nendo::deform
