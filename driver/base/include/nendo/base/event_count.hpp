#pragma once
// Wakes a thread that waits for other threads' data. The notifying thread pays an atomic addition,
// and a system call only if the waiter sleeps; there is no lock that a slow side could hold.

#include <atomic>
#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo {

class EventCount {
public:
  /// Any thread, lock-free. What was written before is seen by the thread that wait() returns in.
  void notify() noexcept {
    if ((word_.fetch_add(one_notification, std::memory_order_acq_rel) & sleeps) != 0) wake();
  }

  /// One thread: returns true once it was notified since wait() last returned true, at once if it
  /// has already, or false at `until`. Its one system call is the sleep.
  bool wait(HostTime until) noexcept;

private:
  void wake() noexcept;

  // The lowest bit: the waiter sleeps or is about to; the notifier clears it. The rest counts the
  // notifications, so that one between the look and the sleep is seen by the kernel, which
  // compares.
  static constexpr std::uint32_t sleeps = 1;
  static constexpr std::uint32_t one_notification = 2;

  std::atomic<std::uint32_t> word_{0};
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
  std::uint32_t heard_ = 0; ///< the waiter's own: what it has seen of the count
};

} // namespace nendo
