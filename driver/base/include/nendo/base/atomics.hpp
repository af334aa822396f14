#pragma once
// StdAtomics: the policy over which the lock-free classes of this folder are written. Their tests
// put a policy of their own in its place (tests/explorer), under which the same source runs through
// every execution that the C++ memory model allows.

#include <atomic>
#include <cstddef>

#include <nendo/base/relax.hpp>

namespace nendo {

/// What belongs to different threads is kept this far apart, twice that where prefetchers fetch
/// pairs of lines. A constant, because a class that is laid out by
/// std::hardware_destructive_interference_size changes with the compiler's options.
inline constexpr std::size_t cache_line_bytes = 64;

struct StdAtomics {
  template <class T>
  using Atomic = std::atomic<T>;

  /// What one thread writes and another one reads, and which is no atomic.
  template <class T>
  using Plain = T;

  static void fence(std::memory_order order) noexcept { std::atomic_thread_fence(order); }
  static void relax() noexcept { nendo::relax(); }
};

} // namespace nendo
