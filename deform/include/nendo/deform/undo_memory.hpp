#pragma once
// Memory for undo that grows while it is used. A deformer takes blocks from it without waiting;
// another thread allocates them ahead.

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/base/spsc_ring.hpp>

namespace nendo::deform {

struct SavedBlock;

/// A linked list of blocks.
struct SavedChain {
  SavedBlock* first = nullptr;
  SavedBlock* last = nullptr;
  std::size_t count = 0;
};

/// The memory of one deformer. The deformer keeps the blocks that it has taken and uses them again.
class NENDO_API UndoMemory {
public:
  /// refill() keeps `blocks_ahead` blocks of 832 bytes free until it has allocated `max_bytes`.
  UndoMemory(std::size_t blocks_ahead, std::size_t max_bytes);
  ~UndoMemory();
  UndoMemory(const UndoMemory&) = delete;
  UndoMemory& operator=(const UndoMemory&) = delete;

  /// Allocates blocks until `blocks_ahead` of them are free. Asking thread. Returns false if fewer
  /// blocks are free because the bound or the machine's memory is reached.
  bool refill();
  /// Returns how many bytes have been allocated. Asking thread.
  std::size_t bytes() const noexcept { return bytes_; }

  /// Takes some blocks; the count is 0 if none are ready. Wait-free. Loop's thread.
  SavedChain take() noexcept;
  /// Reports the number of free blocks of the deformer. Wait-free. Loop's thread.
  void report_free(std::size_t blocks) noexcept { free_.store(blocks, std::memory_order_relaxed); }

private:
  std::size_t blocks_ahead_;
  std::size_t slab_blocks_;
  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::vector<std::unique_ptr<SavedBlock[]>> slabs_;
  SpscRing<SavedChain> given_;
  std::atomic<std::size_t> free_{0};
};

/// Returns half of usable_memory() in bytes: the default limit of undo memory.
NENDO_API std::size_t half_of_memory();

} // namespace nendo::deform
