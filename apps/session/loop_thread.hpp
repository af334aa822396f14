#pragma once
// The thread on which a loop runs.

#include <atomic>
#include <future>
#include <thread>
#include <vector>

#include "session/run_session.hpp"

namespace nendo::session {

class LoopThread {
public:
  /// Starts the loop. It runs until stop() or for the duration in `options`. Both arguments must
  /// outlive this.
  LoopThread(flow::DeformLoop& loop, const RunOptions& options)
      : start(HostClock::now()), thread_([this, &loop, &options] {
          prepared_.set_value(flow::make_thread_realtime(options.realtime));
          loop.run(over_, ticks_for(options));
          ended = true;
        }) {}
  ~LoopThread() { stop(); }
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  /// Returns the rights that the thread has asked for. Blocks until it has asked. Call it once.
  std::vector<flow::Grant> grants() { return prepared_.get_future().get(); }
  /// Ends the loop after its present tick, and joins the thread.
  void stop() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
  }

  const HostTime start;
  std::atomic<bool> ended{false};

private:
  std::atomic<bool> over_{false};
  std::promise<std::vector<flow::Grant>> prepared_;
  std::thread thread_;
};

} // namespace nendo::session
