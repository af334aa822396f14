#pragma once
// SpscRing is a lock-free ring of fixed capacity for one producer and one consumer thread. When it
// is full, the newest element is refused and counted; no thread waits. Each side caches the other's
// index and reads it again only when it must. Proof, bounds and figures: RINGS.md.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include <nendo/base/atomics.hpp>

namespace nendo {

/// The counts of an SpscRing: offered = consumed + refused + SpscRing::size(), while both threads
/// are idle. Each count only grows and is written by one thread; other threads may read it at any
/// time.
struct RingCounters {
  std::uint64_t offered = 0;  ///< elements passed to a push
  std::uint64_t refused = 0;  ///< the offered elements that were refused because the ring was full
  std::uint64_t consumed = 0; ///< elements taken out
  std::uint64_t high_water = 0; ///< maximum number of elements at once
};

template <class T, class Atomics = StdAtomics>
class SpscRing {
  using Index = typename Atomics::template Atomic<std::uint64_t>;
  using Element = typename Atomics::template Plain<T>;
  static_assert(std::is_trivially_copyable_v<T> && Index::is_always_lock_free);

public:
  /// Allocates once. The capacity is `at_least` rounded up to a power of two.
  explicit SpscRing(std::size_t at_least)
      : mask_(std::bit_ceil(std::max<std::size_t>(at_least, 2)) - 1),
        slots_(std::make_unique<Slot[]>(mask_ + 1)) {}

  /// Producer only, wait-free. Returns false if the ring is full; the element is then refused and
  /// counted.
  bool try_push(const T& element) noexcept { return push_n({&element, 1}) == 1; }

  /// Producer only, wait-free. Pushes the leading elements that fit, publishes them together and
  /// returns their number; the others are refused and counted.
  std::size_t push_n(std::span<const T> elements) noexcept {
    const std::size_t fitting = claim(elements.size());
    for (std::size_t n = 0; n < fitting; ++n)
      claimed(n) = elements[n];
    if (fitting > 0) commit(fitting);
    if (fitting < elements.size()) refuse(elements.size() - fitting);
    return fitting;
  }

  /// Producer only, wait-free: push_n() in steps, to fill elements in place. claim() returns the
  /// number of free slots, at most `wanted`. The producer writes them through claimed(n), and
  /// commit() publishes the first `count`. refuse() counts elements without a slot.
  [[nodiscard]] std::size_t claim(std::size_t wanted) noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (wanted > capacity() - (tail - cached_head_)) look_at_head();
    return std::min<std::size_t>(wanted, capacity() - (tail - cached_head_));
  }
  Element& claimed(std::size_t n) noexcept {
    return slots_[(tail_.load(std::memory_order_relaxed) + n) & mask_].element;
  }
  void commit(std::size_t count) noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed) + count;
    const std::uint64_t high_water = high_water_.load(std::memory_order_relaxed);
    if (tail - cached_head_ > high_water) { // the cached head may be stale
      look_at_head();
      high_water_.store(std::max(high_water, tail - cached_head_), std::memory_order_relaxed);
    }
    tail_.store(tail, std::memory_order_release);
  }
  void refuse(std::size_t count) noexcept {
    refused_.store(refused_.load(std::memory_order_relaxed) + count, std::memory_order_relaxed);
  }

  /// Consumer only, wait-free. Passes every element present at the call to `sink`, oldest first,
  /// then frees them together. Returns their number.
  template <class Sink>
  std::size_t drain(Sink&& sink) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    look_at_tail();
    for (std::uint64_t at = head; at != cached_tail_; ++at)
      sink(std::as_const(slots_[at & mask_].element));
    if (cached_tail_ != head) head_.store(cached_tail_, std::memory_order_release);
    return static_cast<std::size_t>(cached_tail_ - head);
  }

  /// Consumer only, wait-free. Takes the oldest element. Returns false if there is none.
  bool try_pop(T& element) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head == cached_tail_) look_at_tail();
    if (head == cached_tail_) return false;
    element = slots_[head & mask_].element;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  [[nodiscard]] std::size_t capacity() const noexcept { return mask_ + 1; }
  /// Any thread, wait-free. The size is exact only while both threads are idle.
  [[nodiscard]] std::size_t size() const noexcept {
    const RingCounters now = counters();
    return static_cast<std::size_t>(now.offered - now.refused - now.consumed);
  }
  [[nodiscard]] RingCounters counters() const noexcept {
    const std::uint64_t consumed = head_.load(std::memory_order_acquire);
    const std::uint64_t refused = refused_.load(std::memory_order_relaxed);
    return {tail_.load(std::memory_order_relaxed) + refused, refused, consumed,
            high_water_.load(std::memory_order_relaxed)};
  }

private:
  // A large element has cache lines of its own; for a small one, that would waste most of a line.
  struct alignas(sizeof(T) >= cache_line_bytes / 2 ? cache_line_bytes : alignof(Element)) Slot {
    Element element;
  };

  void look_at_head() noexcept { cached_head_ = head_.load(std::memory_order_acquire); }
  void look_at_tail() noexcept { cached_tail_ = tail_.load(std::memory_order_acquire); }
  const std::size_t mask_;
  std::unique_ptr<Slot[]> slots_;
  alignas(2 * cache_line_bytes) Index tail_{0}; // the producer writes these four
  std::uint64_t cached_head_ = 0;
  Index refused_{0};
  Index high_water_{0};
  alignas(2 * cache_line_bytes) Index head_{0}; // the consumer writes these two
  std::uint64_t cached_tail_ = 0;
};

} // namespace nendo
