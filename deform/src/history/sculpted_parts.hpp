#pragma once
// The parts of a SculptedShape that deformers change, with its undo memory: the shapes before the
// last steps, and after the steps that were undone. It keeps only the blocks that each step
// changed, and a note of each step. When memory ends, the oldest steps are dropped for new ones.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include <nendo/deform/sculpted_shape.hpp>
#include <nendo/deform/undo_memory.hpp>
#include <nendo/deform/vertex_blocks.hpp>

#include "field/block_evaluator.hpp"

namespace nendo::deform {

struct SavedBlock;

/// What is noted of a step, in a list of all steps.
struct StepHead {
  StepNote note;
  SavedBlock* before; ///< the head of the previous step; valid while that step is there
  SavedBlock* after;  ///< the head of the next step, or null
};

/// A block as it was before a step or, once the step is undone, as it was after the step. The first
/// one of a step holds no block but the note of the step.
struct SavedBlock {
  static constexpr std::uint32_t head = ~std::uint32_t{0};

  union {
    VertexBlock content;
    StepHead of_step; ///< if `block` is `head`
  };
  std::uint64_t stamp;
  std::uint64_t step; ///< that changed it
  SavedBlock* next;
  SavedBlock* previous;
  std::uint32_t block;
};

/// Allocates `count` > 0 blocks and touches them all, so that their first use causes no page fault.
std::unique_ptr<SavedBlock[]> make_saved_blocks(std::size_t count, SavedChain& chain);

class ShapeHistory {
  friend class SculptedShape; // which has the functions for notes and fences

public:
  /// Allocates about this many bytes, and one more shape like this one. Later it allocates nothing,
  /// but takes blocks from `more`, if that is not null; `more` must outlive this. Without `more`
  /// and with fewer bytes than a block needs, nothing is kept.
  ShapeHistory(const BlockShape& first, std::size_t bytes, UndoMemory* more);

  /// Returns whether there is any memory, so that revert() can go back.
  bool is_kept() const noexcept { return kept_.block_count() > 0; }
  /// Ends a step, which leads from the shape kept last to this one, and forgets undone steps. If
  /// nothing changed, there is no step. A step that does not fit is not kept, and neither
  /// are those before it.
  void keep(const BlockShape& now, const StepNote& note) noexcept;
  /// Makes `shape` again the shape that was kept last, as keep() and undo() would, so that redo()
  /// leads to what `shape` is now. It drops no step that can be undone: without memory it only
  /// makes the shape what it was. Does nothing if nothing is kept or nothing has changed.
  void keep_undone(BoundedShape& shape, const StepNote& note) noexcept;
  /// Adds a step that does not change the shape, and forgets undone steps.
  void mark(const StepNote& note) noexcept;
  /// Makes `shape` again the shape that was kept last.
  void revert(BoundedShape& shape) const noexcept;
  /// Undoes the last step. `shape` must be the shape that was kept last. Does nothing if there is
  /// no step, or none after the fence.
  void undo(BoundedShape& shape) noexcept;
  /// Does the last undone step again. `shape` must be the shape that was kept last. Does nothing
  /// if there is no undone step.
  void redo(BoundedShape& shape) noexcept;

  std::size_t steps() const noexcept { return steps_ - fence_; } ///< that undo() may undo

private:
  /// Returns the head of the next step to undo, or to redo; null if there is none.
  SavedBlock* next_head(HistoryMove move) const noexcept;
  std::size_t count_changed(const BlockShape& now) const noexcept;
  bool take_more(std::size_t blocks) noexcept;
  bool free_blocks(std::size_t blocks) noexcept;
  SavedBlock& take() noexcept;
  void begin_step(const StepNote& note) noexcept;
  void save(std::size_t block) noexcept;
  void exchange(SavedBlock& saved, BoundedShape& shape) noexcept;
  void add_free(const SavedChain& chain) noexcept;
  void forget_undone() noexcept;
  void drop_oldest() noexcept;

  BlockShape kept_;
  std::unique_ptr<SavedBlock[]> own_;
  UndoMemory* more_;
  SavedBlock* free_ = nullptr; ///< a list by `next`
  std::size_t free_count_ = 0;
  SavedBlock* oldest_ = nullptr; ///< the oldest block of all steps, undone ones at the end
  SavedBlock* newest_ = nullptr;
  SavedBlock* present_ = nullptr; ///< the last that is not undone; nullptr: all are
  std::size_t undone_blocks_ = 0;
  std::size_t steps_ = 0;
  std::size_t fence_ = 0; ///< as many steps are not undone
  std::size_t undone_ = 0;
  std::size_t forgotten_ = 0;
  std::uint64_t next_step_ = 0;
  std::uint64_t version_ = 0;
  SavedBlock* head_ = nullptr;       ///< head of the last step that is not undone, or null
  SavedBlock* first_head_ = nullptr; ///< head of the oldest step
};

struct SculptedShape::Parts {
  BoundedShape original;
  BoundedShape now;
  ShapeHistory history;
  StepNote note{}; ///< the note for the next step
  StepNote note_of_reset{};
  /// Whether `now` may differ from the shape that was kept last. To find out reads a stamp per
  /// block, which is too much for the tick that takes another version of a large model.
  bool is_changed = false;

  /// Returns the present shape, for writing.
  BoundedShape& change() noexcept {
    is_changed = true;
    return now;
  }
  /// Ends a step, which led to the present shape.
  void keep() noexcept {
    if (std::exchange(is_changed, false)) history.keep(now.shape, note);
  }
  /// Makes the present shape the one that was kept last.
  void revert() noexcept {
    if (std::exchange(is_changed, false)) history.revert(now);
  }
  /// What was made since the last step is a step, but in a redo, which drops it.
  void go(HistoryMove move) noexcept {
    if (move == HistoryMove::redo) {
      revert();
      history.redo(now);
      return;
    }
    keep();
    if (move == HistoryMove::undo) {
      history.undo(now);
    } else {
      now.follow(original);
      history.keep(now.shape, note_of_reset);
    }
  }
};

} // namespace nendo::deform
