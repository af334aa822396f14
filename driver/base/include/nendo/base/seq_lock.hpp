#pragma once
// SeqLock: the word of a sequence lock, for one writer and any number of readers, also in other
// processes. Its value tells which content, by number, stands beside it: 2 n + 1 while content n is
// written, 2 n + 2 when it is whole. Readers cannot hold the writer up. The content itself must be
// read and written by relaxed atomic accesses (H.-J. Boehm, "Can seqlocks get along with
// programming language memory models?", MSPC 2012). Proof: RINGS.md.

#include <cstdint>

#include <nendo/base/atomics.hpp>

namespace nendo {

template <class Atomics = StdAtomics>
class SeqLock {
public:
  /// Writer, wait-free. Call it before the first word of content `number` is written; numbers only
  /// grow.
  void open(std::uint64_t number) noexcept {
    word_.store(2 * number + 1, std::memory_order_relaxed);
    Atomics::fence(std::memory_order_release); // whoever sees a word of it sees this, too
  }
  /// Writer, wait-free. Call it after the last word of the content is written.
  void close(std::uint64_t number) noexcept {
    word_.store(2 * number + 2, std::memory_order_release);
  }

  /// Reader, wait-free. Says whether content `number` is whole; call it before reading.
  bool holds(std::uint64_t number) const noexcept {
    return word_.load(std::memory_order_acquire) == 2 * number + 2;
  }
  /// Reader, wait-free. Says whether all that was read since holds() was of that content.
  bool still_holds(std::uint64_t number) const noexcept {
    Atomics::fence(std::memory_order_acquire); // a later content's word brings its mark along
    return word_.load(std::memory_order_relaxed) == 2 * number + 2;
  }

private:
  typename Atomics::template Atomic<std::uint64_t> word_{0};
};

} // namespace nendo
