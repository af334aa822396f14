#pragma once
// The thread on which a loop runs.

#include <atomic>
#include <cstdint>
#include <future>
#include <limits>
#include <thread>
#include <vector>

#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/realtime.hpp>

namespace nendo::sculpting {

/// Asking thread, except for `ended`.
class LoopThread {
public:
  /// Starts the loop, which must outlive this. It runs until stop(), or for `max_ticks`.
  explicit LoopThread(flow::DeformLoop& loop, const flow::RealtimeOptions& realtime = {},
                      std::uint64_t max_ticks = std::numeric_limits<std::uint64_t>::max())
      : start(HostClock::now()), thread_([this, &loop, realtime, max_ticks] {
          prepared_.set_value(flow::make_thread_realtime(realtime));
          loop.run(over_, max_ticks);
          ended = true;
        }) {}
  ~LoopThread() { stop(); }
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  /// Returns the thread's rights. Blocks until it has requested them. Call it once.
  std::vector<flow::Grant> grants() { return prepared_.get_future().get(); }
  /// Ends the loop after its current tick, and joins the thread.
  void stop() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
  }

  const HostTime start;
  std::atomic<bool> ended{false}; ///< the loop has run its ticks, or was stopped. Thread-safe.

private:
  std::atomic<bool> over_{false};
  std::promise<std::vector<flow::Grant>> prepared_;
  std::thread thread_;
};

} // namespace nendo::sculpting
