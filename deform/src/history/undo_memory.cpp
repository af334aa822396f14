#include <nendo/deform/undo_memory.hpp>

#include <algorithm>
#include <new>

#include <nendo/base/usable_memory.hpp>

#include "history/sculpted_parts.hpp"

namespace nendo::deform {

namespace {

constexpr std::size_t min_slab = 64; // blocks
constexpr std::size_t max_slabs_waiting = 64;
constexpr std::size_t slabs_ahead = 4;

} // namespace

std::unique_ptr<SavedBlock[]> make_saved_blocks(std::size_t count, SavedChain& chain) {
  auto blocks = std::make_unique<SavedBlock[]>(count);
  for (std::size_t at = 0; at + 1 < count; ++at)
    blocks[at].next = &blocks[at + 1];
  chain = {&blocks[0], &blocks[count - 1], count};
  return blocks;
}

UndoMemory::UndoMemory(std::size_t blocks_ahead, std::size_t max_bytes)
    : blocks_ahead_(blocks_ahead),
      slab_blocks_(std::max(min_slab, (blocks_ahead + slabs_ahead - 1) / slabs_ahead)),
      max_bytes_(max_bytes), given_(max_slabs_waiting) {}

UndoMemory::~UndoMemory() = default;

// What the deformer takes in between is counted twice or not at all; the next call makes it good.
bool UndoMemory::refill() {
  while (free_.load(std::memory_order_relaxed) + given_.size() * slab_blocks_ < blocks_ahead_) {
    const std::size_t slab_bytes = slab_blocks_ * sizeof(SavedBlock);
    if (slab_bytes > max_bytes_ - std::min(bytes_, max_bytes_)) return false;
    try {
      SavedChain chain;
      slabs_.push_back(make_saved_blocks(slab_blocks_, chain));
      if (!given_.try_push(chain)) {
        slabs_.pop_back();
        return true;
      }
    } catch (const std::bad_alloc&) {
      return false;
    }
    bytes_ += slab_bytes;
  }
  return true;
}

SavedChain UndoMemory::take() noexcept {
  SavedChain chain;
  return given_.try_pop(chain) ? chain : SavedChain{};
}

std::size_t half_of_memory() {
  return usable_memory() / 2;
}

} // namespace nendo::deform
