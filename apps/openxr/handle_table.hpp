#pragma once
// What the layer knows of the handles that an application has. The tables are static, so that
// nothing is allocated, and nothing is left after the library is unloaded.

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace nendo::openxr {

/// OpenXR requires that an application uses a handle only after it was created and before it is
/// destroyed, in whatever threads. So an entry never changes hands while find() returns it, and
/// only the list of handles is read while others are added and removed.
template <class Handle, class Entry, std::size_t capacity>
class HandleTable {
public:
  /// Any thread, wait-free. Returns null for an unknown handle.
  Entry* find(Handle handle) noexcept {
    const auto wanted = std::bit_cast<std::uint64_t>(handle);
    if (wanted == 0) return nullptr;
    for (std::size_t n = 0; n < capacity; ++n)
      if (handles_[n].load(std::memory_order_relaxed) == wanted) return &entries_[n];
    return nullptr;
  }

  /// Under the layer's lock. Returns a new entry without a handle, or null if the table is full.
  Entry* reserve() noexcept {
    for (std::size_t n = 0; n < capacity; ++n) {
      if (handles_[n].load(std::memory_order_relaxed) != 0) continue;
      std::destroy_at(&entries_[n]);
      return std::construct_at(&entries_[n]);
    }
    return nullptr;
  }
  /// Under the layer's lock. Gives a reserved entry its handle.
  void add(const Entry* entry, Handle handle) noexcept {
    handles_[index_of(entry)].store(std::bit_cast<std::uint64_t>(handle),
                                    std::memory_order_relaxed);
  }
  /// Under the layer's lock.
  void remove(const Entry* entry) noexcept {
    handles_[index_of(entry)].store(0, std::memory_order_relaxed);
  }
  /// Under the layer's lock. Calls `use` with each entry that has a handle.
  template <class Use>
  void for_each(Use&& use) noexcept {
    for (std::size_t n = 0; n < capacity; ++n)
      if (handles_[n].load(std::memory_order_relaxed) != 0) use(entries_[n]);
  }

private:
  std::size_t index_of(const Entry* entry) const noexcept {
    return static_cast<std::size_t>(entry - entries_.data());
  }

  std::array<std::atomic<std::uint64_t>, capacity> handles_{};
  std::array<Entry, capacity> entries_{};
};

} // namespace nendo::openxr
