#pragma once
// Serves an emulated glove from a thread of its own.

#include <atomic>
#include <thread>

#include <nendo/emulator/emulator.hpp>

namespace nendo::emulator {

class ServedEmulator {
public:
  /// `emulator` must outlive this.
  explicit ServedEmulator(DeviceEmulator& emulator)
      : thread_([this, &emulator] {
          served_ = emulator.serve(over_);
          over_ = true; // nothing waits for an emulator that has failed
        }) {}
  ServedEmulator(const ServedEmulator&) = delete;
  ServedEmulator& operator=(const ServedEmulator&) = delete;
  ~ServedEmulator() { stop(); }

  /// Returns whether serving was ended, or failed.
  bool is_over() const noexcept { return over_; }
  /// Ends serving when all sent bytes have gone out. Returns the result of serving. Blocks briefly.
  Result<void> finish() {
    stop();
    return served_;
  }

private:
  void stop() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
  }

  std::atomic<bool> over_{false};
  Result<void> served_;
  std::thread thread_;
};

} // namespace nendo::emulator
