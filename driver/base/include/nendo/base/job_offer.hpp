#pragma once
// A job that one thread offers to another. If the other thread runs, it takes the job; if not, the
// first thread withdraws it. So nobody waits for a thread that has no processor.

#include <atomic>
#include <cstdint>

#include <nendo/base/atomics.hpp>

namespace nendo {

/// All of it is wait-free. What was written before offer() is seen after take(), and what was
/// written before done() after is_done().
template <class Job, class Atomics = StdAtomics>
class JobOffer {
public:
  /// Offering thread: offers a job. The job before must have been withdrawn or be done.
  void offer(const Job& job) noexcept {
    job_ = job;
    done_.store(0, std::memory_order_relaxed);
    open_.store(1, std::memory_order_release);
  }
  /// Offering thread, once a job: takes the job back. False: the other thread has taken it.
  bool withdraw() noexcept { return open_.exchange(0, std::memory_order_relaxed) == 1; }
  /// Offering thread: says whether a job that could not be withdrawn is done.
  bool is_done() const noexcept { return done_.load(std::memory_order_acquire) == 1; }

  /// Other thread: takes the job. False: there is none. The job is this thread's until done().
  bool take(Job& job) noexcept {
    if (open_.load(std::memory_order_relaxed) == 0) return false; // spares others' caches
    if (open_.exchange(0, std::memory_order_acquire) == 0) return false;
    job = job_;
    return true;
  }
  void done() noexcept { done_.store(1, std::memory_order_release); }

private:
  template <class T>
  using Atomic = typename Atomics::template Atomic<T>;

  // Two threads ask for the 1, and one gets it.
  alignas(2 * cache_line_bytes) Atomic<std::uint32_t> open_{0};
  Atomic<std::uint32_t> done_{0};
  typename Atomics::template Plain<Job> job_{};
};

} // namespace nendo
