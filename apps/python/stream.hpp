#pragma once
// The samples of a device on their way to Python. A thread of its own, which never takes the GIL,
// moves them from the device's ring to a bounded queue, so that none is lost while Python is busy.

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <nendo/base/event_count.hpp>
#include <nendo/base/notifying_ring.hpp>
#include <nendo/base/units.hpp>

namespace nendo::python {

/// Thread-safe, except for begin() and end().
template <class Sample>
class Stream {
public:
  /// At most `capacity` samples wait; the oldest ones are dropped and counted.
  explicit Stream(std::size_t capacity) : capacity_(capacity) {}
  ~Stream() { end(); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// The device's thread is its producer.
  NotifyingRing<Sample>& ring() noexcept { return ring_; }

  /// Starts the thread. It calls `has_ended`, which returns whether no further sample will come.
  void begin(std::function<bool()> has_ended) {
    is_over_ = is_stopped_ = false;
    thread_ = std::thread([this, has_ended = std::move(has_ended)] {
      constexpr std::chrono::milliseconds longest_sleep{50}; // until it notices an end
      while (!is_stopped_) {
        const bool is_last = has_ended();
        drain(is_last);
        if (is_last) return;
        event_count_.wait(HostClock::now() + longest_sleep);
      }
      drain(true);
    });
  }
  /// Ends the thread, after the samples in the ring. The device must have stopped.
  void end() {
    is_stopped_ = true;
    event_count_.notify();
    if (thread_.joinable()) thread_.join();
  }

  /// Blocks until there is a sample, or none will come, or until that time. Returns false only at
  /// that time.
  bool wait(HostTime until) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_until(lock, until, [this] { return !waiting_.empty() || is_over_; });
  }
  /// Takes all samples that wait, oldest first.
  std::vector<Sample> take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<Sample> all(waiting_.begin(), waiting_.end());
    waiting_.clear();
    return all;
  }
  std::uint64_t dropped() const noexcept { return dropped_; }

private:
  void drain(bool is_last) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ring_.drain([this](const Sample& sample) noexcept { waiting_.push_back(sample); });
    for (; waiting_.size() > capacity_; ++dropped_)
      waiting_.pop_front();
    if (is_last) is_over_ = true;
    changed_.notify_all();
  }

  const std::size_t capacity_;
  EventCount event_count_;
  NotifyingRing<Sample> ring_{4096, &event_count_};
  std::mutex mutex_; ///< guards `waiting_` and `is_over_`
  std::condition_variable changed_;
  std::deque<Sample> waiting_;
  bool is_over_ = false;
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> is_stopped_{false};
  std::thread thread_;
};

} // namespace nendo::python
