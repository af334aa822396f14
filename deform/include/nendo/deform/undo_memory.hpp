#pragma once
// Memory for undo that grows while it is used: a deformer takes of it without waiting, and another
// thread sees to it that there is some.

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include <nendo/base/spsc_ring.hpp>

namespace nendo::deform {

struct SavedBlock;

/// Blocks, each of which knows the next.
struct SavedChain {
  SavedBlock* first = nullptr;
  SavedBlock* last = nullptr;
  std::size_t count = 0;
};
/// Allocates `count` > 0 blocks and touches them all, so that their first use is no page fault.
std::unique_ptr<SavedBlock[]> make_saved_blocks(std::size_t count, SavedChain& chain);

/// For one deformer. Blocks that were taken are never given back, but used again.
class UndoMemory {
public:
  /// refill() keeps so many blocks free, 832 bytes each, until `most_bytes` have been allocated.
  UndoMemory(std::size_t blocks_ahead, std::size_t most_bytes);
  ~UndoMemory();
  UndoMemory(const UndoMemory&) = delete;
  UndoMemory& operator=(const UndoMemory&) = delete;

  /// Any one thread at a time. Allocates. False: there is no more to be had, and free blocks are
  /// fewer than they ought to be.
  bool refill();
  /// As refill(). What has been allocated.
  std::size_t bytes() const noexcept { return bytes_; }

  /// The deformer's thread only, wait-free. Nothing came: count is 0.
  SavedChain take() noexcept;
  /// The same. How many blocks it has left of those that it took, and had of its own.
  void tell_free(std::size_t blocks) noexcept { free_.store(blocks, std::memory_order_relaxed); }

private:
  std::size_t blocks_ahead_;
  std::size_t slab_blocks_;
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::vector<std::unique_ptr<SavedBlock[]>> slabs_;
  SpscRing<SavedChain> given_;
  std::atomic<std::size_t> free_{0};
};

/// Half of what the program may use, in bytes: so much may be kept for undo where nobody says how
/// much. As usable_memory().
std::size_t half_of_memory();

} // namespace nendo::deform
