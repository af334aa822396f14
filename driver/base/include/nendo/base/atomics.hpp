#pragma once
// StdAtomics is the policy that the lock-free classes of this folder use for their atomics. Their
// tests use another policy (tests/explorer), under which the same source runs through every
// execution that the C++ memory model allows.

#include <atomic>
#include <cstddef>

namespace nendo {

/// The size of a cache line, in bytes, for alignment against false sharing. Classes use twice the
/// size, because prefetchers may fetch pairs of lines. It is a constant, because
/// std::hardware_destructive_interference_size, and so the layout, depends on compiler options.
inline constexpr std::size_t cache_line_bytes = 64;

struct StdAtomics {
  template <class T>
  using Atomic = std::atomic<T>;

  /// Non-atomic data that one thread writes and another thread reads.
  template <class T>
  using Plain = T;

  static void fence(std::memory_order order) noexcept { std::atomic_thread_fence(order); }
};

/// A spin-wait hint for the processor, which saves power and lets the core's other hardware thread
/// run. Takes about 10 to 60 ns. Wait-free.
inline void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

} // namespace nendo
