#include <nendo/deform/block_evaluator.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include "evaluator_parts.hpp"

namespace nendo::deform {

namespace {

/// So many blocks at a time are one thread's: enough to be worth the asking.
constexpr std::size_t blocks_a_piece = 16;

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

void ListRoom::reserve(std::size_t entries) {
  if (indices_[0] != nullptr && entries <= entries_) return;
  entries_ = entries;
  for (auto& array : indices_)
    array = hwy::AllocateAligned<std::uint32_t>(list_room(entries));
  for (auto& array : numbers_)
    array = hwy::AllocateAligned<float>(list_room(entries));
}

BlockEvaluator::Parts::Parts(const BlockLayout& layout, Eigen::Index entries, int threads)
    : field(layout, entries), reached(layout.block_count(), 0) {
  if (threads > 1) worker.emplace();
  for (auto& room : lists)
    room.reserve(static_cast<std::size_t>(entries));
}

BlockEvaluator::BlockEvaluator(const BlockLayout& layout, Eigen::Index entries,
                               const EvaluationOptions& options)
    : parts_(std::make_unique<Parts>(layout, entries, options.threads)) {}
BlockEvaluator::~BlockEvaluator() = default;
BlockEvaluator::BlockEvaluator(BlockEvaluator&&) noexcept = default;
BlockEvaluator& BlockEvaluator::operator=(BlockEvaluator&&) noexcept = default;

bool BlockEvaluator::set_field(const CsrbfField& field) noexcept {
  for (auto& room : parts_->lists)
    room.reserve(static_cast<std::size_t>(field.centres.cols()));
  return parts_->field.assign(field, BlockField::Zeros::left_out);
}

bool BlockEvaluator::fits(const BoundedShape& shape) const noexcept {
  return shape.extent + parts_->field.bound(shape.extent) <= most_units;
}

bool BlockEvaluator::displace(const BoundedShape& from, BlockShape& to) noexcept {
  if (to.block_count() != from.shape.block_count()) to = from.shape;
  if (!fits(from)) {
    to.follow(from.shape);
    return false;
  }
  const std::uint64_t stamp = BlockShape::new_stamp();
  Parts& parts = *parts_;
  parts.in_pieces(from.shape.block_count(), blocks_a_piece,
                  [&](std::size_t begin, std::size_t end, std::size_t thread) {
                    displace_pass(parts.field.view(),
                                  {from.shape.data(), to.data(), from.bounds.data(), nullptr,
                                   parts.reached.data(), begin, end,
                                   parts.lists[thread].scratch()});
                    for (std::size_t block = begin; block < end; ++block)
                      if (parts.reached[block] > 0) {
                        to.set_stamp(block, stamp);
                      } else {
                        to.follow(from.shape, block);
                      }
                  });
  return true;
}

bool BlockEvaluator::displace(BoundedShape& shape) noexcept {
  // Bounds on bounds grow with each step: measured before they are believed.
  if (!fits(shape)) shape.extent = extent_of(shape.bounds);
  if (!fits(shape)) return false;
  shape.extent += parts_->field.bound(shape.extent);
  const std::uint64_t stamp = BlockShape::new_stamp();
  Parts& parts = *parts_;
  parts.in_pieces(shape.shape.block_count(), blocks_a_piece,
                  [&](std::size_t begin, std::size_t end, std::size_t thread) {
                    displace_pass(parts.field.view(),
                                  {shape.shape.data(), shape.shape.data(), shape.bounds.data(),
                                   shape.bounds.data(), parts.reached.data(), begin, end,
                                   parts.lists[thread].scratch()});
                    for (std::size_t block = begin; block < end; ++block)
                      if (parts.reached[block] > 0) shape.shape.set_stamp(block, stamp);
                  });
  return true;
}

} // namespace nendo::deform
