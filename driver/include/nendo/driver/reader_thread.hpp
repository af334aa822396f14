#pragma once
// For drivers, in this library and in programs: a reader thread that can sleep until deadlines, and
// that stop() wakes at once.

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

/// Asking thread, except wait_until(), which `read` calls.
class ReaderThread {
public:
  /// Runs `read` in a new thread; it must return soon after `stop` is requested. `source` names the
  /// glove in messages. Errors: failed (already started, or no thread).
  Result<void> start(const std::string& source,
                     std::function<void(const std::stop_token& stop)> read) {
    if (is_running()) return Error{Errc::failed, source + ": start() was called twice"};
    try {
      thread_ = std::jthread(std::move(read));
    } catch (const std::system_error& error) {
      return Error{Errc::failed, source + ": no thread for the reader: " + error.what()};
    }
    return {};
  }

  bool is_running() const noexcept { return thread_.joinable(); } ///< true until stop()
  /// Requests a stop and joins the thread. Idempotent.
  void stop() noexcept {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
  }

  /// For use in `read`: sleeps until `due`. Returns false if a stop was requested.
  bool wait_until(const std::stop_token& stop, HostTime due) {
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, stop, due, [] { return false; });
    return !stop.stop_requested();
  }

private:
  std::mutex mutex_; ///< only for the condition variable
  std::condition_variable_any wake_;
  std::jthread thread_; // last, so joined before the others are destroyed
};

} // namespace nendo::driver
