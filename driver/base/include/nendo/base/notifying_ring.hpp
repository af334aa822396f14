#pragma once
// An SpscRing that wakes its consumer.

#include <cstddef>

#include <nendo/base/event_count.hpp>
#include <nendo/base/spsc_ring.hpp>

namespace nendo {

/// Carries samples from a device's reader thread to one consumer thread. Each push notifies the
/// event count, if there is one, so that the consumer can sleep until a sample comes.
template <class Sample>
class NotifyingRing {
public:
  /// Allocates once, `at_least` samples rounded up to a power of two. `event_count` may serve
  /// several rings; it must outlive them.
  explicit NotifyingRing(std::size_t at_least, EventCount* event_count = nullptr)
      : ring_(at_least), event_count_(event_count) {}

  /// Producer only, wait-free but for the system call that wakes the consumer. False: the ring is
  /// full; the sample is refused and counted.
  bool try_push(const Sample& sample) noexcept {
    const bool taken = ring_.try_push(sample);
    if (event_count_ != nullptr) event_count_->notify();
    return taken;
  }

  // As in SpscRing: consumer only; size() and counters() are thread-safe.
  bool try_pop(Sample& sample) noexcept { return ring_.try_pop(sample); }
  template <class Sink>
  std::size_t drain(Sink&& sink) noexcept {
    return ring_.drain(sink);
  }
  [[nodiscard]] std::size_t capacity() const noexcept { return ring_.capacity(); }
  [[nodiscard]] std::size_t size() const noexcept { return ring_.size(); }
  [[nodiscard]] RingCounters counters() const noexcept { return ring_.counters(); }

private:
  SpscRing<Sample> ring_;
  EventCount* const event_count_;
};

} // namespace nendo
