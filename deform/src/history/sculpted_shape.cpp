#include <nendo/deform/sculpted_shape.hpp>

#include <algorithm>
#include <cassert>
#include <utility>

#include <nendo/deform/deformer_options.hpp>

#include "history/sculpted_parts.hpp"

namespace nendo::deform {

ShapeHistory::ShapeHistory(const BlockShape& first, std::size_t bytes, UndoMemory* more)
    : more_(more) {
  const std::size_t count = bytes / sizeof(SavedBlock);
  if (count == 0 && more == nullptr) return;
  kept_ = first;
  if (count > 0) {
    SavedChain chain;
    own_ = make_saved_blocks(count, chain);
    add_free(chain);
  }
  if (more_ != nullptr) more_->report_free(free_count_);
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

/// Takes memory until so many blocks are free. Returns false if there is no more.
bool ShapeHistory::take_more(std::size_t blocks) noexcept {
  while (more_ != nullptr && free_count_ < blocks) {
    const SavedChain chain = more_->take();
    if (chain.count == 0) break;
    add_free(chain);
  }
  return blocks <= free_count_;
}

/// Takes memory, and drops the oldest steps, until so many blocks are free. Returns false if there
/// are no more to drop.
bool ShapeHistory::free_blocks(std::size_t blocks) noexcept {
  take_more(blocks);
  for (; steps_ > 0 && free_count_ < blocks; ++forgotten_)
    drop_oldest();
  return blocks <= free_count_;
}

void ShapeHistory::keep(const BlockShape& now, const StepNote& note) noexcept {
  const std::size_t changed = count_changed(now);
  if (changed == 0) return;
  forget_undone();
  const bool fits = free_blocks(changed + 1);
  if (fits) begin_step(note);
  for (std::size_t block = 0; block < kept_.block_count(); ++block) {
    if (now.stamp(block) == kept_.stamp(block)) continue;
    if (fits) save(block);
    kept_.follow(now, block);
  }
  if (!fits) ++forgotten_;
  if (more_ != nullptr) more_->report_free(free_count_);
}

void ShapeHistory::keep_undone(BoundedShape& shape, const StepNote& note) noexcept {
  const std::size_t changed = count_changed(shape.shape);
  if (changed == 0) return;
  forget_undone();
  if (take_more(changed + 1)) {
    keep(shape.shape, note);
    undo(shape);
    return;
  }
  revert(shape);
  if (more_ != nullptr) more_->report_free(free_count_);
}

void ShapeHistory::mark(const StepNote& note) noexcept {
  if (!is_kept()) return;
  forget_undone();
  if (free_blocks(1)) begin_step(note);
  if (more_ != nullptr) more_->report_free(free_count_);
}

/// Takes a free block, of which there must be one, to the end of the list.
SavedBlock& ShapeHistory::take() noexcept {
  SavedBlock* const saved = free_;
  free_ = saved->next;
  --free_count_;
  saved->step = next_step_;
  saved->next = nullptr;
  saved->previous = newest_;
  (newest_ != nullptr ? newest_->next : oldest_) = saved;
  newest_ = present_ = saved;
  return *saved;
}

void ShapeHistory::begin_step(const StepNote& note) noexcept {
  ++next_step_;
  ++steps_;
  ++version_;
  SavedBlock& saved = take();
  saved.block = SavedBlock::head;
  saved.of_step = {note, head_, nullptr};
  if (head_ != nullptr)
    head_->of_step.after = &saved;
  else
    first_head_ = &saved;
  head_ = &saved;
}

void ShapeHistory::save(std::size_t block) noexcept {
  SavedBlock& saved = take();
  saved.content = kept_[block];
  saved.stamp = kept_.stamp(block);
  saved.block = static_cast<std::uint32_t>(block);
}

SavedBlock* ShapeHistory::next_head(HistoryMove move) const noexcept {
  assert(move != HistoryMove::reset);
  if (move == HistoryMove::undo) return steps() > 0 ? head_ : nullptr;
  if (undone_ == 0) return nullptr;
  return head_ != nullptr ? head_->of_step.after : first_head_;
}

void ShapeHistory::forget_undone() noexcept {
  if (undone_ == 0) return;
  add_free({present_ != nullptr ? present_->next : oldest_, newest_, undone_blocks_});
  newest_ = present_;
  (present_ != nullptr ? present_->next : oldest_) = nullptr;
  (head_ != nullptr ? head_->of_step.after : first_head_) = nullptr;
  undone_ = undone_blocks_ = 0;
  ++version_;
}

/// Where none are undone.
void ShapeHistory::drop_oldest() noexcept {
  const std::uint64_t step = oldest_->step;
  first_head_ = first_head_->of_step.after;
  while (oldest_ != nullptr && oldest_->step == step) {
    SavedBlock* const dropped = std::exchange(oldest_, oldest_->next);
    add_free({dropped, dropped, 1});
  }
  --steps_;
  if (fence_ > 0) --fence_;
  if (oldest_ == nullptr)
    newest_ = present_ = head_ = nullptr;
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

void ShapeHistory::revert(BoundedShape& shape) const noexcept {
  for (std::size_t block = 0; block < kept_.block_count(); ++block) {
    if (shape.shape.stamp(block) == kept_.stamp(block)) continue;
    shape.shape.follow(kept_, block);
    shape.bounds[block] = bounds_of(kept_[block]);
  }
}

void ShapeHistory::undo(BoundedShape& shape) noexcept {
  if (steps() == 0) return;
  const std::uint64_t step = present_->step;
  for (; present_ != nullptr && present_->step == step; present_ = present_->previous) {
    if (present_->block != SavedBlock::head) exchange(*present_, shape);
    ++undone_blocks_;
  }
  --steps_;
  ++undone_;
  head_ = steps_ > 0 ? head_->of_step.before : nullptr;
  ++version_;
}

void ShapeHistory::redo(BoundedShape& shape) noexcept {
  if (undone_ == 0) return;
  SavedBlock* next = present_ != nullptr ? present_->next : oldest_;
  head_ = next;
  const std::uint64_t step = next->step;
  for (; next != nullptr && next->step == step; next = next->next) {
    if (next->block != SavedBlock::head) exchange(*next, shape);
    present_ = next;
    --undone_blocks_;
  }
  ++steps_;
  --undone_;
  ++version_;
}

SculptedShape::SculptedShape(BlockLayout layout, const DeformerOptions& options,
                             const BlockShape* first)
    : layout_(std::move(layout)) {
  BoundedShape loaded(layout_.pack());
  BoundedShape now = first != nullptr ? BoundedShape(*first) : loaded;
  assert(now.shape.block_count() == layout_.block_count());
  ShapeHistory history(now.shape, options.undo_bytes, options.undo_memory);
  parts_ = std::make_unique<Parts>(Parts{std::move(loaded), std::move(now), std::move(history)});
}

SculptedShape::~SculptedShape() = default;

const BlockShape& SculptedShape::shape() const noexcept {
  return parts_->now.shape;
}

std::size_t SculptedShape::undo_steps() const noexcept {
  return parts_->history.steps();
}

std::size_t SculptedShape::redo_steps() const noexcept {
  return parts_->history.undone_;
}

std::size_t SculptedShape::forgotten_steps() const noexcept {
  return parts_->history.forgotten_;
}

void SculptedShape::set_notes(const StepNote& note, const StepNote& of_reset) noexcept {
  parts_->note = note;
  parts_->note_of_reset = of_reset;
}

void SculptedShape::mark(const StepNote& note) noexcept {
  parts_->history.mark(note);
}

void SculptedShape::pass_mark(HistoryMove move) noexcept {
  assert(move != HistoryMove::reset);
  parts_->revert();
  if (move == HistoryMove::undo)
    parts_->history.undo(parts_->now);
  else
    parts_->history.redo(parts_->now);
}

const StepNote* SculptedShape::next_note(HistoryMove move) const noexcept {
  const SavedBlock* const head = parts_->history.next_head(move);
  return head != nullptr ? &head->of_step.note : nullptr;
}

void SculptedShape::set_next_note(HistoryMove move, const StepNote& note) noexcept {
  parts_->history.next_head(move)->of_step.note = note;
  ++parts_->history.version_;
}

std::size_t SculptedShape::copy_notes(HistoryMove move, std::span<StepNote> notes) const noexcept {
  const bool undoes = move == HistoryMove::undo;
  const std::size_t count = std::min(notes.size(), undoes ? undo_steps() : redo_steps());
  const SavedBlock* head = parts_->history.next_head(move);
  for (StepNote& note : notes.first(count)) {
    note = head->of_step.note;
    head = undoes ? head->of_step.before : head->of_step.after;
  }
  return count;
}

std::uint64_t SculptedShape::history_version() const noexcept {
  return parts_->history.version_;
}

void SculptedShape::fence() noexcept {
  ShapeHistory& history = parts_->history;
  history.forget_undone();
  history.fence_ = history.steps_;
  ++history.version_;
}

void SculptedShape::unfence() noexcept {
  parts_->history.fence_ = 0;
  ++parts_->history.version_;
}

} // namespace nendo::deform
