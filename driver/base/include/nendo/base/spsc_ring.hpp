#pragma once
// SpscRing: one producer thread, one consumer thread, lock-free, fixed capacity. When it is full
// the newest element is refused and counted; nobody ever waits. Indices run freely over 64 bits;
// each side caches the other's index and looks at the shared one only when the cached value no
// longer suffices.

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>

namespace nendo {

inline constexpr std::size_t cache_line_bytes = 64;

/// Monotonic counts; once both sides are at rest: offered = consumed + refused + size().
struct RingCounters {
  std::uint64_t offered = 0;  ///< pushes tried
  std::uint64_t refused = 0;  ///< pushes refused because the ring was full
  std::uint64_t consumed = 0; ///< elements taken out
};

template <class T>
class SpscRing {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

public:
  /// Allocates once. The capacity is `at_least` rounded up to a power of two.
  explicit SpscRing(std::size_t at_least)
      : mask_(std::bit_ceil(std::max<std::size_t>(at_least, 2)) - 1),
        slots_(std::make_unique<Slot[]>(mask_ + 1)) {}

  /// Producer only, wait-free. False: full, the element was refused and counted.
  bool try_push(const T& element) noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - cached_head_ > mask_) {
      cached_head_ = head_.load(std::memory_order_acquire);
      if (tail - cached_head_ > mask_) {
        refused_.store(refused_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        return false;
      }
    }
    slots_[tail & mask_].element = element;
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  /// Consumer only, wait-free: hands every element present at the call to `sink`, oldest first, and
  /// frees them together. Returns how many there were.
  template <class Sink>
  std::size_t drain(Sink&& sink) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    const std::uint64_t tail = tail_.load(std::memory_order_acquire);
    for (std::uint64_t at = head; at != tail; ++at)
      sink(std::as_const(slots_[at & mask_].element));
    cached_tail_ = tail;
    head_.store(tail, std::memory_order_release);
    return static_cast<std::size_t>(tail - head);
  }

  /// Consumer only, wait-free.
  bool try_pop(T& element) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head == cached_tail_) {
      cached_tail_ = tail_.load(std::memory_order_acquire);
      if (head == cached_tail_) return false;
    }
    element = slots_[head & mask_].element;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  [[nodiscard]] std::size_t capacity() const noexcept { return mask_ + 1; }
  /// Any thread; exact only while both sides are at rest.
  [[nodiscard]] std::size_t size() const noexcept {
    const std::uint64_t head = head_.load(std::memory_order_acquire);
    return static_cast<std::size_t>(tail_.load(std::memory_order_acquire) - head);
  }
  /// Any thread, wait-free.
  [[nodiscard]] RingCounters counters() const noexcept {
    const std::uint64_t consumed = head_.load(std::memory_order_acquire);
    const std::uint64_t refused = refused_.load(std::memory_order_relaxed);
    return {tail_.load(std::memory_order_acquire) + refused, refused, consumed};
  }

private:
  // A slot starts on a cache line where that does not waste most of it: neighbours then never share
  // one.
  struct alignas(sizeof(T) >= cache_line_bytes / 2 ? cache_line_bytes : alignof(T)) Slot {
    T element;
  };

  const std::size_t mask_;
  std::unique_ptr<Slot[]> slots_;
  // Written by the producer.
  alignas(2 * cache_line_bytes) std::atomic<std::uint64_t> tail_{0};
  std::uint64_t cached_head_ = 0;
  std::atomic<std::uint64_t> refused_{0};
  // Written by the consumer.
  alignas(2 * cache_line_bytes) std::atomic<std::uint64_t> head_{0};
  std::uint64_t cached_tail_ = 0;
};

} // namespace nendo
