#pragma once
// Sends hands by OSC over UDP on a thread of its own. The loop puts each frame into a ring. Neither
// thread waits for the other.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nendo/base/unique_fd.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo_publish.h>

#include "publish/frame_record.hpp"
#include "publish/target.hpp"
#include "publish/vmc_bones.hpp"

namespace nendo::publish {

/// After OscPublisher::end(), records = sent + skipped + lost.
struct OscCounts {
  std::uint64_t records = 0; ///< frames shown
  std::uint64_t sent = 0;    ///< records that the sending thread has sent
  std::uint64_t skipped = 0; ///< records that the option `rate` left out
  std::uint64_t lost = 0;    ///< records that were overwritten before the sending thread read them
  std::uint64_t datagrams = 0; ///< that the system accepted
  std::uint64_t refused = 0;   ///< that the system did not accept; those are lost
  std::uint64_t bytes = 0;     ///< all bytes of the accepted datagrams
};

class OscPublisher final : public flow::FrameSink {
public:
  /// name: the target as the user wrote it, for error messages.
  OscPublisher(std::string name, const OscTarget& target)
      : name_(std::move(name)), target_(target), to_(target.endpoint.socket_address()) {}
  ~OscPublisher() override { end(); }

  /// Begins to send. To be called before each loop's first tick, while no loop runs. The first call
  /// opens the socket. Errors: failed (no way to that address), no_permission.
  Result<void> begin(const LoopOutline& outline);
  /// Puts the frame into the ring. Wait-free: no allocation, lock or system call.
  void show(const flow::Frame& frame) noexcept override;
  /// Sends the remaining records and joins the thread. To be called while no loop runs.
  void end();

  /// Returns the counts. To be called after end().
  OscCounts counts() const noexcept { return counts_; }

private:
  struct Record {
    nendo_publish_record hands;
    nendo_publish_states states;
  };

  Result<void> open();
  void send_until_over() noexcept;
  void send_new() noexcept;
  void send(const Record& record);
  void send_datagram(std::span<const std::byte> datagram) noexcept;

  std::string name_;
  OscTarget target_;
  SocketAddress to_;
  UniqueFd socket_;
  // Used by the loop's thread.
  std::unique_ptr<AtomicWord[]> memory_;
  RecordRing ring_;
  std::uint64_t shown_ = 0;
  alignas(2 * cache_line_bytes) std::atomic<std::uint64_t> newest_{0};
  std::atomic<bool> over_{false};
  // Used by the sending thread.
  alignas(2 * cache_line_bytes) std::uint64_t next_ = 1;
  std::array<std::optional<VmcHand>, 2> avatar_; ///< left, right
  std::optional<std::int64_t> first_ns_;         ///< when the first record's tick woke
  std::int64_t due_ns_ = 0;                      ///< records of earlier ticks are skipped
  OscCounts counts_;
  std::thread thread_;
};

} // namespace nendo::publish
