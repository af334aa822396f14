#pragma once
// SeqLock is the sequence word of a seqlock, for one writer and any number of readers, also in
// other processes. Its value is 2 n + 1 while content number n is being written, and 2 n + 2 when
// that is complete. Readers cannot delay the writer. The content itself must be read and written by
// relaxed atomic accesses (H.-J. Boehm, "Can seqlocks get along with programming language memory
// models?", MSPC 2012). Proof: RINGS.md.

#include <cstdint>

#include <nendo/base/atomics.hpp>

namespace nendo {

template <class Atomics = StdAtomics>
class SeqLock {
public:
  /// Writer only, wait-free. Call it before the first write of content `number`. Numbers must
  /// increase.
  void open(std::uint64_t number) noexcept {
    word_.store(2 * number + 1, std::memory_order_relaxed);
    Atomics::fence(
        std::memory_order_release); // a reader of any word of the content sees this store
  }
  /// Writer only, wait-free. Call it after the last write of the content.
  void close(std::uint64_t number) noexcept {
    word_.store(2 * number + 2, std::memory_order_release);
  }

  /// Reader, wait-free. Returns whether content `number` is complete. Call it before reading.
  bool holds(std::uint64_t number) const noexcept {
    return word_.load(std::memory_order_acquire) == 2 * number + 2;
  }
  /// Reader, wait-free. Returns whether all reads since holds() belong to content `number`.
  bool still_holds(std::uint64_t number) const noexcept {
    Atomics::fence(std::memory_order_acquire); // a reader of newer content sees its open()
    return word_.load(std::memory_order_relaxed) == 2 * number + 2;
  }

private:
  typename Atomics::template Atomic<std::uint64_t> word_{0};
};

} // namespace nendo
