#include "shape_history.hpp"

#include <utility>

#include "saved_block.hpp"

namespace nendo::deform {

ShapeHistory::ShapeHistory(const BlockShape& first, std::size_t bytes, UndoMemory* more)
    : more_(more) {
  const std::size_t count = bytes / sizeof(SavedBlock);
  if (count == 0 && more == nullptr) return;
  kept_ = first;
  own(count);
  if (more_ != nullptr) more_->tell_free(free_count_);
}

ShapeHistory::~ShapeHistory() = default;

void ShapeHistory::own(std::size_t count) {
  if (count == 0) return;
  SavedChain chain;
  own_.push_back(make_saved_blocks(count, chain));
  add_free(chain);
}

void ShapeHistory::add_free(const SavedChain& chain) noexcept {
  chain.last->next = free_;
  free_ = chain.first;
  free_count_ += chain.count;
}

std::size_t ShapeHistory::count_changed(const BlockShape& now) const noexcept {
  std::size_t changed = 0;
  for (std::size_t block = 0; block < kept_.block_count(); ++block)
    if (now.stamp(block) != kept_.stamp(block)) ++changed;
  return changed;
}

void ShapeHistory::keep(const BlockShape& now) noexcept {
  const std::size_t changed = count_changed(now);
  if (changed == 0) return;
  forget_undone();
  while (more_ != nullptr && free_count_ < changed) {
    const SavedChain chain = more_->take();
    if (chain.count == 0) break;
    add_free(chain);
  }
  for (; steps_ > 0 && free_count_ < changed; ++forgotten_)
    drop_oldest();
  const bool fits = changed <= free_count_;
  for (std::size_t block = 0; block < kept_.block_count(); ++block) {
    if (now.stamp(block) == kept_.stamp(block)) continue;
    if (fits) save(block);
    kept_.follow(now, block);
  }
  if (fits) {
    ++steps_;
    ++next_step_;
  } else {
    ++forgotten_;
  }
  if (more_ != nullptr) more_->tell_free(free_count_);
}

void ShapeHistory::save(std::size_t block) noexcept {
  SavedBlock* const saved = free_;
  free_ = saved->next;
  --free_count_;
  saved->content = kept_[block];
  saved->stamp = kept_.stamp(block);
  saved->step = next_step_;
  saved->block = static_cast<std::uint32_t>(block);
  saved->next = nullptr;
  saved->previous = newest_;
  (newest_ != nullptr ? newest_->next : oldest_) = saved;
  newest_ = present_ = saved;
}

void ShapeHistory::forget_undone() noexcept {
  if (undone_ == 0) return;
  add_free({present_ != nullptr ? present_->next : oldest_, newest_, undone_blocks_});
  newest_ = present_;
  (present_ != nullptr ? present_->next : oldest_) = nullptr;
  undone_ = undone_blocks_ = 0;
}

/// Where none are undone.
void ShapeHistory::drop_oldest() noexcept {
  const std::uint64_t step = oldest_->step;
  while (oldest_ != nullptr && oldest_->step == step) {
    SavedBlock* const dropped = std::exchange(oldest_, oldest_->next);
    add_free({dropped, dropped, 1});
  }
  --steps_;
  if (fence_ > 0) --fence_;
  if (oldest_ == nullptr)
    newest_ = present_ = nullptr;
  else
    oldest_->previous = nullptr;
}

/// A content comes back with the stamp that it always had.
void ShapeHistory::exchange(SavedBlock& saved, BoundedShape& shape) noexcept {
  const std::uint64_t stamp = kept_.stamp(saved.block);
  std::swap(kept_.data()[saved.block], saved.content);
  kept_.set_stamp(saved.block, std::exchange(saved.stamp, stamp));
  shape.shape.follow(kept_, saved.block);
  shape.bounds[saved.block] = bounds_of(kept_[saved.block]);
}

bool ShapeHistory::undo(BoundedShape& shape) noexcept {
  if (steps() == 0) return false;
  const std::uint64_t step = present_->step;
  for (; present_ != nullptr && present_->step == step; present_ = present_->previous) {
    exchange(*present_, shape);
    ++undone_blocks_;
  }
  --steps_;
  ++undone_;
  return true;
}

bool ShapeHistory::redo(BoundedShape& shape) noexcept {
  if (undone_ == 0) return false;
  for (std::size_t block = 0; block < kept_.block_count(); ++block) {
    if (shape.shape.stamp(block) == kept_.stamp(block)) continue;
    shape.shape.follow(kept_, block);
    shape.bounds[block] = bounds_of(kept_[block]);
  }
  SavedBlock* next = present_ != nullptr ? present_->next : oldest_;
  const std::uint64_t step = next->step;
  for (; next != nullptr && next->step == step; next = next->next) {
    exchange(*next, shape);
    present_ = next;
    --undone_blocks_;
  }
  ++steps_;
  --undone_;
  return true;
}

} // namespace nendo::deform
