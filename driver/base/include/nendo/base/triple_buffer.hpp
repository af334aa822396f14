#pragma once
// TripleBuffer passes the newest value from one writer thread to one reader thread through three
// buffers. The writer fills its buffer in place and publishes it with one atomic exchange, at any
// size of the value. The reader polls for a new value. Both sides are wait-free and never touch the
// same buffer. Proof, bounds and figures: RINGS.md.

#include <array>
#include <cstdint>

#include <nendo/base/atomics.hpp>

namespace nendo {

template <class T, class Atomics = StdAtomics>
class TripleBuffer {
  using Buffer = typename Atomics::template Plain<T>;
  using Middle = typename Atomics::template Atomic<std::uint8_t>;
  static_assert(Middle::is_always_lock_free);

public:
  /// All three buffers start as copies of `initial`, so that vectors have their sizes before
  /// publish().
  explicit TripleBuffer(const T& initial) : buffers_{initial, initial, initial} {}

  /// Writer only. Returns the buffer to fill. It holds an older value; overwrite all of it.
  Buffer& back() noexcept { return buffers_[back_]; }
  /// Writer only, wait-free. Publishes back(). Returns true if this replaced a value that was never
  /// read.
  bool publish() noexcept {
    const std::uint8_t old =
        middle_.exchange(static_cast<std::uint8_t>(back_ | fresh), std::memory_order_acq_rel);
    back_ = old & index_mask;
    return (old & fresh) != 0;
  }

  /// Reader only, wait-free. Makes the latest value front() and returns true if it is new. The
  /// reference from front() stays valid and unchanged until the next update().
  bool update() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & fresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & index_mask;
    return true;
  }
  const Buffer& front() const noexcept { return buffers_[front_]; }

private:
  static constexpr std::uint8_t fresh = 4;
  static constexpr std::uint8_t index_mask = 3;

  std::array<Buffer, 3> buffers_;
  alignas(2 * cache_line_bytes) std::uint8_t back_ = 0;
  alignas(2 * cache_line_bytes) Middle middle_{1};
  alignas(2 * cache_line_bytes) std::uint8_t front_ = 2;
};

} // namespace nendo
