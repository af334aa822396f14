#pragma once
// StdAtomics is the policy that the lock-free classes of this folder use for their atomics. Their
// tests use another policy (tests/explorer), under which the same source runs through every
// execution that the C++ memory model allows.

#include <atomic>
#include <cstddef>

namespace nendo {

/// The distance in bytes that separates the data of different threads. Classes keep twice that
/// distance where prefetchers fetch pairs of lines. It is a constant, because a class that is laid
/// out by std::hardware_destructive_interference_size changes with the compiler's options.
inline constexpr std::size_t cache_line_bytes = 64;

struct StdAtomics {
  template <class T>
  using Atomic = std::atomic<T>;

  /// Data that one thread writes and another one reads, and that is not atomic by itself.
  template <class T>
  using Plain = T;

  static void fence(std::memory_order order) noexcept { std::atomic_thread_fence(order); }
};

/// Marks this thread as spinning for the processor, so that the core's other hardware thread may
/// run and less power is drawn. Takes some 10 to 60 ns. Wait-free.
inline void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

} // namespace nendo
