#pragma once
// The baseline of `nendo bench rt`: a ring like published designs. Indices wrap, one slot stays
// empty to distinguish full from empty, each side caches the other's index, and every index has a
// cache line of its own. Such designs let the allocator decide where the slots lie: glibc puts a
// large block 16 bytes after a cache line's beginning, and a smaller one anywhere. Here the place
// is a parameter, so that all runs are alike.

#include <atomic>
#include <cstddef>
#include <new>
#include <type_traits>
#include <vector>

#include <nendo/base/atomics.hpp>

namespace nendo::bench {

template <class T>
class PlainRing {
  static_assert(std::is_trivially_copyable_v<T>);

public:
  /// The first slot begins `offset_bytes`, a multiple of T's alignment, behind a cache line's
  /// beginning.
  PlainRing(std::size_t capacity, std::size_t offset_bytes)
      : slots_(capacity + 1), memory_(slots_ * sizeof(T) / cache_line_bytes + 2),
        elements_(new(memory_.front().bytes + offset_bytes) T[slots_]) {}

  bool try_push(const T& element) noexcept {
    const std::size_t write = write_.load(std::memory_order_relaxed);
    const std::size_t next = write + 1 == slots_ ? 0 : write + 1;
    if (next == cached_read_) {
      cached_read_ = read_.load(std::memory_order_acquire);
      if (next == cached_read_) return false;
    }
    elements_[write] = element;
    write_.store(next, std::memory_order_release);
    return true;
  }

  /// Returns the oldest element, in its place, or null if there is none.
  const T* front() noexcept {
    const std::size_t read = read_.load(std::memory_order_relaxed);
    if (read == cached_write_) {
      cached_write_ = write_.load(std::memory_order_acquire);
      if (read == cached_write_) return nullptr;
    }
    return &elements_[read];
  }
  void pop() noexcept {
    const std::size_t read = read_.load(std::memory_order_relaxed);
    read_.store(read + 1 == slots_ ? 0 : read + 1, std::memory_order_release);
  }

private:
  struct alignas(cache_line_bytes) Line {
    std::byte bytes[cache_line_bytes];
  };

  std::size_t slots_;
  std::vector<Line> memory_;
  T* elements_;
  alignas(cache_line_bytes) std::atomic<std::size_t> write_{0};
  alignas(cache_line_bytes) std::size_t cached_read_ = 0;
  alignas(cache_line_bytes) std::atomic<std::size_t> read_{0};
  alignas(cache_line_bytes) std::size_t cached_write_ = 0;
};

} // namespace nendo::bench
