#pragma once
// For drivers, in this library and in programs: the reader thread of a glove that is in this
// process. It sleeps to deadlines, and stops at once.

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>

namespace nendo::driver {

/// Asking thread, but for wait_until(), which the reader calls.
class ReaderThread {
public:
  /// Runs `read` until it returns, which it does soon after `stop` was asked for. `source` names
  /// the glove. Errors: failed (not stopped since it was started, no thread).
  Result<void> start(const std::string& source,
                     std::function<void(const std::stop_token& stop)> read) {
    if (thread_.joinable()) return Error{Errc::failed, source + ": start() was called twice"};
    try {
      thread_ = std::jthread(std::move(read));
    } catch (const std::system_error& error) {
      return Error{Errc::failed, source + ": no thread for the reader: " + error.what()};
    }
    return {};
  }

  /// Asks the thread to stop, and waits for its end. Idempotent.
  void stop() noexcept {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
  }

  /// For use in `read`: sleeps until `due`. Returns false if the thread has to stop.
  bool wait_until(const std::stop_token& stop, HostTime due) {
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, stop, due, [] { return false; });
    return !stop.stop_requested();
  }

private:
  std::mutex mutex_; ///< used by no other thread; the wait needs one
  std::condition_variable_any wake_;
  std::jthread thread_; // last: joined before what it uses is gone
};

} // namespace nendo::driver
