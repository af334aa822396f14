#pragma once
// The shapes before the last steps, and after the steps that were undone. It keeps only the blocks
// that each step changed. When memory ends, the oldest steps make room for new ones.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <nendo/deform/undo_memory.hpp>

#include "block_evaluator.hpp"

namespace nendo::deform {

class ShapeHistory {
public:
  /// Allocates about this many bytes, and one more shape like this one. Later it allocates nothing,
  /// but takes blocks from `more`, if that is not null; `more` must outlive this. Without `more`
  /// and with fewer bytes than a block needs, nothing is kept.
  ShapeHistory(const BlockShape& first, std::size_t bytes, UndoMemory* more);
  ~ShapeHistory();
  ShapeHistory(ShapeHistory&&) noexcept = default;

  /// Ends a step, which leads from the shape kept last to this one, and forgets undone steps. If
  /// nothing changed, there is no step. A step for which there is no room is not kept, and neither
  /// are those before it.
  void keep(const BlockShape& now) noexcept;
  /// Undoes the last step. `shape` must be the shape that was kept last. Returns false if there is
  /// no step, or none behind the fence.
  bool undo(BoundedShape& shape) noexcept;
  /// Does the last undone step again, from the shape that was kept last; later changes of `shape`
  /// are dropped. Returns false, and changes nothing, if there is no undone step.
  bool redo(BoundedShape& shape) noexcept;

  /// Makes undo() stop here, and forgets the undone steps.
  void fence() noexcept {
    forget_undone();
    fence_ = steps_;
  }
  void unfence() noexcept { fence_ = 0; }

  std::size_t steps() const noexcept { return steps_ - fence_; } ///< that undo() may undo
  std::size_t undone() const noexcept { return undone_; }
  std::size_t forgotten() const noexcept { return forgotten_; } ///< for want of memory

private:
  bool is_kept() const noexcept { return kept_.block_count() > 0; }
  std::size_t count_changed(const BlockShape& now) const noexcept;
  void save(std::size_t block) noexcept;
  void exchange(SavedBlock& saved, BoundedShape& shape) noexcept;
  void own(std::size_t count);
  void add_free(const SavedChain& chain) noexcept;
  void forget_undone() noexcept;
  void drop_oldest() noexcept;

  BlockShape kept_;
  std::vector<std::unique_ptr<SavedBlock[]>> own_;
  UndoMemory* more_;
  SavedBlock* free_ = nullptr; ///< by `next`
  std::size_t free_count_ = 0;
  SavedBlock* oldest_ = nullptr; ///< of the steps, undone ones at the end
  SavedBlock* newest_ = nullptr;
  SavedBlock* present_ = nullptr; ///< the last that is not undone; nullptr: all are
  std::size_t undone_blocks_ = 0;
  std::size_t steps_ = 0;
  std::size_t fence_ = 0; ///< as many steps are not undone
  std::size_t undone_ = 0;
  std::size_t forgotten_ = 0;
  std::uint64_t next_step_ = 0;
};

} // namespace nendo::deform
