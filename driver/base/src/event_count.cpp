#include <nendo/base/event_count.hpp>

#include <ctime>

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace nendo {
namespace {

static_assert(sizeof(std::atomic<std::uint32_t>) == sizeof(std::uint32_t)); // what a futex is

long futex(std::atomic<std::uint32_t>& word, int what, std::uint32_t value,
           const timespec* until) noexcept {
  return ::syscall(SYS_futex, &word, what | FUTEX_PRIVATE_FLAG, value, until, nullptr,
                   FUTEX_BITSET_MATCH_ANY);
}

} // namespace

bool EventCount::wait(HostTime until) noexcept {
  const auto whole = std::chrono::floor<std::chrono::seconds>(until.time_since_epoch());
  timespec at{};
  at.tv_sec = static_cast<std::time_t>(whole.count());
  at.tv_nsec = static_cast<long>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(until.time_since_epoch() - whole)
          .count());
  for (;;) {
    std::uint32_t word = word_.load(std::memory_order_acquire);
    if ((word & ~sleeps) != heard_) {
      heard_ = word & ~sleeps;
      return true;
    }
    if (HostClock::now() >= until) return false;
    if ((word & sleeps) == 0 && !word_.compare_exchange_weak(word, word | sleeps)) continue;
    // With a bit set the deadline is absolute, of CLOCK_MONOTONIC. It also returns for signals.
    futex(word_, FUTEX_WAIT_BITSET, word | sleeps, &at);
  }
}

void EventCount::wake() noexcept {
  word_.fetch_and(~sleeps, std::memory_order_acq_rel);
  futex(word_, FUTEX_WAKE, 1, nullptr);
}

} // namespace nendo
