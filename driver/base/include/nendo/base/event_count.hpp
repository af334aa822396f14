#pragma once
// Wakes a thread that waits for other threads' data. A notification costs an atomic addition, and a
// system call only if the waiter sleeps. There is no lock that a slow thread could hold.

#include <atomic>
#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo {

class NENDO_API EventCount {
public:
  /// Notifies the waiter. May be called from any thread; lock-free. The waiter sees everything that
  /// was written before this call as soon as its wait() returns.
  void notify() noexcept {
    if ((word_.fetch_add(one_notification, std::memory_order_acq_rel) & sleeps) != 0) wake();
  }

  /// Waits for a notification; only one thread may call it. Returns true as soon as there was one
  /// since wait() last returned true, or false at `until`. The only system call is the sleep.
  bool wait(HostTime until) noexcept;

private:
  void wake() noexcept;

  // The lowest bit says that the waiter sleeps or is about to sleep; the notifier clears it. The
  // other bits count notifications, so that the kernel, which compares the word, sees one that
  // comes between the waiter's last look and its sleep.
  static constexpr std::uint32_t sleeps = 1;
  static constexpr std::uint32_t one_notification = 2;

  std::atomic<std::uint32_t> word_{0};
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
  std::uint32_t heard_ = 0; ///< the last count seen by the waiter; waiter's thread only
};

} // namespace nendo
