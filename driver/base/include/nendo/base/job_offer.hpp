#pragma once
// Hands a job from one thread to another. The offering thread can withdraw a job that was not
// taken, so that it never waits for a thread that is not scheduled.

#include <atomic>
#include <cstdint>

#include <nendo/base/atomics.hpp>

namespace nendo {

/// All functions are wait-free. Writes before offer() are visible after take(), and writes before
/// done() are visible after is_done(), if these return true.
template <class Job, class Atomics = StdAtomics>
class JobOffer {
public:
  /// Offering thread only. The previous job must be withdrawn or done.
  void offer(const Job& job) noexcept {
    job_ = job;
    done_.store(0, std::memory_order_relaxed);
    open_.store(1, std::memory_order_release);
  }
  /// Offering thread only, at most once per job. Withdraws the job; returns false if the other
  /// thread has taken it.
  bool withdraw() noexcept { return open_.exchange(0, std::memory_order_relaxed) == 1; }
  /// Offering thread only. Returns whether a job that could not be withdrawn is done.
  bool is_done() const noexcept { return done_.load(std::memory_order_acquire) == 1; }

  /// Other thread only. Takes the job, which belongs to this thread until done(). Returns false if
  /// there is none.
  bool take(Job& job) noexcept {
    if (open_.load(std::memory_order_relaxed) == 0)
      return false; // no write to the shared cache line
    if (open_.exchange(0, std::memory_order_acquire) == 0) return false;
    job = job_;
    return true;
  }
  void done() noexcept { done_.store(1, std::memory_order_release); }

private:
  template <class T>
  using Atomic = typename Atomics::template Atomic<T>;

  // 1 while a job is offered. Both threads exchange it for 0, and only one of them gets the 1.
  alignas(2 * cache_line_bytes) Atomic<std::uint32_t> open_{0};
  Atomic<std::uint32_t> done_{0};
  typename Atomics::template Plain<Job> job_{};
};

} // namespace nendo
