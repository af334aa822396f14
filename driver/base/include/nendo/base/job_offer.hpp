#pragma once
// A job that one thread offers to another. If the other thread runs, it takes the job; if not, the
// first thread withdraws it. So no thread waits for one without a processor.

#include <atomic>
#include <cstdint>

#include <nendo/base/atomics.hpp>

namespace nendo {

/// All functions are wait-free. What was written before offer() is seen after take(), and what was
/// written before done() is seen after is_done().
template <class Job, class Atomics = StdAtomics>
class JobOffer {
public:
  /// Offering thread only. Offers a job. The previous job must have been withdrawn or be done.
  void offer(const Job& job) noexcept {
    job_ = job;
    done_.store(0, std::memory_order_relaxed);
    open_.store(1, std::memory_order_release);
  }
  /// Offering thread only, at most once for each job. Takes the job back. Returns false if the
  /// other thread has taken it.
  bool withdraw() noexcept { return open_.exchange(0, std::memory_order_relaxed) == 1; }
  /// Offering thread only. Returns whether a job that could not be withdrawn is done.
  bool is_done() const noexcept { return done_.load(std::memory_order_acquire) == 1; }

  /// Other thread only. Takes the job, which belongs to this thread until done(). Returns false if
  /// there is none.
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

  // The value 1 means that a job is on offer. Both threads exchange it for 0, and only one of them
  // gets the 1.
  alignas(2 * cache_line_bytes) Atomic<std::uint32_t> open_{0};
  Atomic<std::uint32_t> done_{0};
  typename Atomics::template Plain<Job> job_{};
};

} // namespace nendo
