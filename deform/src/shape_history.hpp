#pragma once
// What a shape was before its last steps, and after those that were undone: of each step the blocks
// that it changed. Where memory ends, the oldest steps make room for new ones.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <nendo/deform/undo_memory.hpp>

#include "block_evaluator.hpp"

namespace nendo::deform {

class ShapeHistory {
public:
  /// Allocates about so many bytes, and for one more shape like this one; nothing afterwards, but
  /// takes what comes from `more`, if any, which must outlive it. With less than a block and no
  /// more nothing is ever kept.
  ShapeHistory(const BlockShape& first, std::size_t bytes, UndoMemory* more);
  ~ShapeHistory();

  /// Ends a step: from what was kept last to this. No step if nothing changed; otherwise undone
  /// steps are forgotten. A step for which there is no room at all is not kept, nor are those
  /// before it.
  void keep(const BlockShape& now) noexcept;
  /// Undoes the last step; the shape is what was kept last. False: there is none.
  bool undo(BoundedShape& shape) noexcept;
  /// Does again what was undone last, to what was kept last: what the shape has become since is
  /// dropped. False: there is none, and nothing changes.
  bool redo(BoundedShape& shape) noexcept;

  std::size_t steps() const noexcept { return steps_; }
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
  std::size_t undone_ = 0;
  std::size_t forgotten_ = 0;
  std::uint64_t next_step_ = 0;
};

} // namespace nendo::deform
