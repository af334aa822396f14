#pragma once
// A futex-based event count for one waiting thread. A notification costs one atomic addition, and a
// system call only if the waiter sleeps. There is no lock.

#include <atomic>
#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo {

class NENDO_API EventCount {
public:
  /// Notifies the waiter. Thread-safe; lock-free. Writes before this call are visible to the waiter
  /// after its wait() returns.
  void notify() noexcept {
    if ((word_.fetch_add(one_notification, std::memory_order_acq_rel) & sleeps) != 0) wake();
  }

  /// Blocks until a notification has come since wait() last returned true, and returns true;
  /// returns false at `until`. Only one thread may call it. The only system call is the sleep.
  bool wait(HostTime until) noexcept;

private:
  void wake() noexcept;

  // The lowest bit is set while the waiter sleeps or is about to; the notifier clears it. The other
  // bits count notifications, so that the futex does not sleep if one comes between the waiter's
  // last load and its sleep.
  static constexpr std::uint32_t sleeps = 1;
  static constexpr std::uint32_t one_notification = 2;

  std::atomic<std::uint32_t> word_{0};
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
  std::uint32_t heard_ = 0; ///< the last count seen by the waiter; waiter's thread only
};

} // namespace nendo
