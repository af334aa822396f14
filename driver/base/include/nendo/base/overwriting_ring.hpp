#pragma once
// OverwritingRing: one producer thread, one consumer thread, lock-free, fixed capacity. A push
// never fails: when the consumer lags, the oldest elements are overwritten, and the consumer counts
// exactly those that it will never see. Each slot tells the number k of its element: 2k + 1 while
// that is written, 2k + 2 when it is whole (a sequence lock; H.-J. Boehm, "Can seqlocks get along
// with programming language memory models?", MSPC 2012, has why the payload must be atomic).
// Proof, bounds and figures: RINGS.md.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>

#include <nendo/base/atomics.hpp>
#include <nendo/base/ring_counters.hpp>

namespace nendo {

template <class T, class Atomics = StdAtomics>
class OverwritingRing {
  using Word = typename Atomics::template Atomic<std::uint64_t>;
  static_assert(std::is_trivially_copyable_v<T> && std::is_default_constructible_v<T>);
  static_assert(Word::is_always_lock_free);

public:
  /// Allocates once. The capacity is `at_least` rounded up to a power of two.
  explicit OverwritingRing(std::size_t at_least)
      : mask_(std::bit_ceil(std::max<std::size_t>(at_least, 2)) - 1),
        slots_(std::make_unique<Slot[]>(mask_ + 1)) {}

  /// Producer only, wait-free.
  void push(const T& element) noexcept {
    Words words{};
    std::memcpy(words.data(), &element, sizeof element);
    const std::uint64_t number = pushed_.load(std::memory_order_relaxed);
    Slot& slot = slots_[number & mask_];
    slot.stage.store(2 * number + 1, std::memory_order_relaxed);
    Atomics::fence(std::memory_order_release); // whoever sees a word of this element sees its mark
    for (std::size_t n = 0; n < words.size(); ++n)
      slot.words[n].store(words[n], std::memory_order_relaxed);
    pushed_.store(number + 1, std::memory_order_relaxed);
    slot.stage.store(2 * number + 2, std::memory_order_release);
  }

  /// Consumer only, wait-free. False: nothing new.
  bool try_pop(T& element) noexcept {
    for (std::size_t tries = 2 * capacity(); tries > 0; --tries) {
      const Look look = look_at_next(element);
      if (look != Look::overtaken) return look == Look::whole;
    }
    return false; // a producer that overtook us so often leaves us nothing for now
  }

  /// Consumer only, wait-free: hands up to capacity() elements to `sink`, oldest first. Returns how
  /// many.
  template <class Sink>
  std::size_t drain(Sink&& sink) noexcept {
    T element{};
    std::size_t got = 0;
    while (got < capacity() && try_pop(element)) {
      sink(std::as_const(element));
      ++got;
    }
    return got;
  }

  [[nodiscard]] std::size_t capacity() const noexcept { return mask_ + 1; }
  /// Any thread, wait-free; exact only while both sides are at rest. The consumer never sees more
  /// got and lost than pushed.
  [[nodiscard]] OverwritingRingCounters counters() const noexcept {
    return {pushed_.load(std::memory_order_relaxed), got_.load(std::memory_order_relaxed),
            lost_.load(std::memory_order_relaxed)};
  }

private:
  using Words = std::array<std::uint64_t, (sizeof(T) + 7) / 8>;
  struct alignas(cache_line_bytes) Slot {
    Word stage{0};
    std::array<Word, std::tuple_size_v<Words>> words{};
  };
  enum class Look { nothing, whole, overtaken };

  Look look_at_next(T& element) noexcept {
    const std::uint64_t got = got_.load(std::memory_order_relaxed);
    const std::uint64_t lost = lost_.load(std::memory_order_relaxed);
    const std::uint64_t next = got + lost;
    const Slot& slot = slots_[next & mask_];
    std::uint64_t stage = slot.stage.load(std::memory_order_acquire);
    if (stage < 2 * next + 2) return Look::nothing;
    if (stage == 2 * next + 2) {
      Words words;
      for (std::size_t n = 0; n < words.size(); ++n)
        words[n] = slot.words[n].load(std::memory_order_relaxed);
      Atomics::fence(std::memory_order_acquire); // a word of a later element brings its mark along
      stage = slot.stage.load(std::memory_order_relaxed);
      if (stage == 2 * next + 2) {
        std::memcpy(static_cast<void*>(&element), words.data(), sizeof element);
        got_.store(got + 1, std::memory_order_relaxed);
        return Look::whole;
      }
    }
    // Of what came before this later element, the last capacity() - 1 may still be there.
    const std::uint64_t later = (stage - 1) / 2;
    lost_.store(lost + (later - mask_ - next), std::memory_order_relaxed);
    return Look::overtaken;
  }

  const std::size_t mask_;
  std::unique_ptr<Slot[]> slots_;
  alignas(2 * cache_line_bytes) Word pushed_{0}; // written by the producer
  alignas(2 * cache_line_bytes) Word got_{0};    // these two by the consumer
  Word lost_{0};
};

} // namespace nendo
