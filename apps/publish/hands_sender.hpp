#pragma once
// Passes the hands of each frame from the loop to a thread of its own, which sends them. Neither
// thread waits for the other.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include <nendo/base/units.hpp>
#include <nendo/flow/frame.hpp>

#include "publish/frame_record.hpp"
#include "publish/hands_record.hpp"

namespace nendo::publish {

/// After HandsSender::end(), records = sent + skipped + lost.
struct SenderCounts {
  std::uint64_t records = 0; ///< frames shown
  std::uint64_t sent = 0;    ///< records that the sending thread has sent
  std::uint64_t skipped = 0; ///< records that the rate left out
  std::uint64_t lost = 0;    ///< records that were overwritten before the sending thread read them
};

class HandsSender {
public:
  /// max_rate_hz: records per second; nothing: every tick's.
  explicit HandsSender(std::optional<double> max_rate_hz) : pace_(max_rate_hz) {}
  ~HandsSender() { end(); }
  HandsSender(const HandsSender&) = delete;
  HandsSender& operator=(const HandsSender&) = delete;

  /// Starts the thread, which calls `send` for each record, and `turn`, if there is such a
  /// function, about once a millisecond. To be called before each loop's first tick, while no loop
  /// runs.
  void begin(std::function<void(const HandsRecord&)> send, std::function<void()> turn = {});
  /// Loop's thread. Wait-free: no allocation, lock or system call.
  void show(const flow::Frame& frame) noexcept;
  /// Sends the remaining records and joins the thread. To be called while no loop runs.
  void end();

  /// Returns the counts of all loops. To be called after end().
  const SenderCounts& counts() const noexcept { return counts_; }

private:
  void run();
  void send_new();

  // Used by the loop's thread.
  std::unique_ptr<AtomicWord[]> memory_;
  RecordRing ring_;
  std::uint64_t shown_ = 0;
  alignas(2 * cache_line_bytes) std::atomic<std::uint64_t> newest_{0};
  std::atomic<bool> over_{false};
  // Used by the sending thread.
  alignas(2 * cache_line_bytes) std::uint64_t next_ = 1;
  std::function<void(const HandsRecord&)> send_;
  std::function<void()> turn_;
  Pace pace_;
  SenderCounts counts_;
  std::thread thread_;
};

} // namespace nendo::publish
