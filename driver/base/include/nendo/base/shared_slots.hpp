#pragma once
// SharedSlots passes the newest value of one writer to any number of readers, which use it in
// place. A value that readers still use stays untouched, so that the writer may then release what
// it refers to, as a mapping of memory. The counts are split, as A. Williams describes ("C++
// Concurrency in Action", 7.2): how often a value was acquired is in one word with its slot, and
// how often it was released is beside the value. Proof: RINGS.md.

#include <array>
#include <cstddef>
#include <cstdint>

#include <nendo/base/atomics.hpp>

namespace nendo {

template <class T, std::size_t slots, class Atomics = StdAtomics>
class SharedSlots {
  using Count = typename Atomics::template Atomic<std::uint64_t>;
  using Value = typename Atomics::template Plain<T>;
  static_assert(slots > 1 && slots <= 256);

public:
  /// Readers, wait-free. Returns the slot of the newest value, which stays unchanged until
  /// release().
  std::size_t acquire() noexcept {
    return current_.fetch_add(one_use, std::memory_order_acquire) % one_use;
  }
  const Value& operator[](std::size_t slot) const noexcept { return values_[slot]; }
  /// Readers, wait-free. Call it once per acquire(), after the last use of the value.
  void release(std::size_t slot) noexcept {
    released_[slot].fetch_add(1, std::memory_order_release);
  }

  /// Writer only, wait-free. Returns whether the slot is not the newest one and no reader uses it.
  bool is_free(std::size_t slot) const noexcept {
    return slot != newest_ && released_[slot].load(std::memory_order_acquire) == acquired_[slot];
  }
  /// Writer only. The value of a free slot, or the newest value for reading.
  Value& at(std::size_t slot) noexcept { return values_[slot]; }
  /// Writer only. The slot of the newest value; 0 at first.
  std::size_t newest() const noexcept { return newest_; }
  /// Writer only, wait-free. Makes the value of a free slot the newest one.
  void publish(std::size_t slot) noexcept {
    const std::uint64_t old = current_.exchange(slot, std::memory_order_release);
    acquired_[newest_] += old / one_use;
    newest_ = slot;
  }

private:
  static constexpr std::uint64_t one_use = 256;

  alignas(2 * cache_line_bytes) Count current_{0}; ///< the slot, plus one_use per acquire()
  alignas(2 * cache_line_bytes) std::array<Count, slots> released_{};
  std::array<std::uint64_t, slots> acquired_{}; ///< up to the latest publish() of another slot
  std::size_t newest_ = 0;
  std::array<Value, slots> values_{};
};

} // namespace nendo
