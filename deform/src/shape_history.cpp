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

void ShapeHistory::carry(const BlockShape& now, const BlockShape& normals) {
  if (!is_kept()) return;
  kept_.follow(now);
  kept_normals_ = normals;
  forget_undone();
  while (steps_ > 0)
    drop_oldest();
  own(free_count_);
  if (more_ != nullptr) more_->tell_free(free_count_);
}

std::size_t ShapeHistory::count_changed(const BlockShape& now,
                                        const BlockShape& kept) const noexcept {
  std::size_t changed = 0;
  for (std::size_t block = 0; block < kept.block_count(); ++block)
    if (now.stamp(block) != kept.stamp(block)) ++changed;
  return changed;
}

void ShapeHistory::keep(const BlockShape& now, const BlockShape& normals) noexcept {
  const std::size_t changed = count_changed(now, kept_) + count_changed(normals, kept_normals_);
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
  save_changed(now, kept_, false, fits);
  save_changed(normals, kept_normals_, true, fits);
  if (fits) {
    ++steps_;
    ++next_step_;
  } else {
    ++forgotten_;
  }
  if (more_ != nullptr) more_->tell_free(free_count_);
}

void ShapeHistory::save_changed(const BlockShape& now, BlockShape& kept, bool of_normals,
                                bool fits) noexcept {
  for (std::size_t block = 0; block < kept.block_count(); ++block) {
    if (now.stamp(block) == kept.stamp(block)) continue;
    if (fits) save(kept, block, of_normals);
    kept.follow(now, block);
  }
}

void ShapeHistory::save(const BlockShape& kept, std::size_t block, bool of_normals) noexcept {
  SavedBlock* const saved = free_;
  free_ = saved->next;
  --free_count_;
  saved->content = kept[block];
  saved->stamp = kept.stamp(block);
  saved->step = next_step_;
  saved->block = static_cast<std::uint32_t>(block);
  saved->of_normals = of_normals;
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
  if (oldest_ == nullptr)
    newest_ = present_ = nullptr;
  else
    oldest_->previous = nullptr;
}

/// A content comes back with the stamp that it always had.
void ShapeHistory::exchange(SavedBlock& saved, BoundedShape& shape, BlockShape& normals) noexcept {
  BlockShape& kept = saved.of_normals ? kept_normals_ : kept_;
  const std::uint64_t stamp = kept.stamp(saved.block);
  std::swap(kept.data()[saved.block], saved.content);
  kept.set_stamp(saved.block, std::exchange(saved.stamp, stamp));
  (saved.of_normals ? normals : shape.shape).follow(kept, saved.block);
  if (!saved.of_normals) shape.bounds[saved.block] = bounds_of(kept[saved.block]);
}

bool ShapeHistory::undo(BoundedShape& shape, BlockShape& normals) noexcept {
  if (steps_ == 0) return false;
  const std::uint64_t step = present_->step;
  for (; present_ != nullptr && present_->step == step; present_ = present_->previous) {
    exchange(*present_, shape, normals);
    ++undone_blocks_;
  }
  --steps_;
  ++undone_;
  return true;
}

bool ShapeHistory::redo(BoundedShape& shape, BlockShape& normals) noexcept {
  if (undone_ == 0) return false;
  for (std::size_t block = 0; block < kept_.block_count(); ++block) {
    if (shape.shape.stamp(block) == kept_.stamp(block)) continue;
    shape.shape.follow(kept_, block);
    shape.bounds[block] = bounds_of(kept_[block]);
  }
  for (std::size_t block = 0; block < kept_normals_.block_count(); ++block)
    normals.follow(kept_normals_, block);
  SavedBlock* next = present_ != nullptr ? present_->next : oldest_;
  const std::uint64_t step = next->step;
  for (; next != nullptr && next->step == step; next = next->next) {
    exchange(*next, shape, normals);
    present_ = next;
    --undone_blocks_;
  }
  ++steps_;
  --undone_;
  return true;
}

} // namespace nendo::deform
