#pragma once
// Sends hands by OSC over UDP, on a thread of its own.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <nendo/base/endpoint.hpp>
#include <nendo/base/unique_fd.hpp>
#include <nendo/flow/frame.hpp>

#include "publish/frame_record.hpp"
#include "publish/hands_sender.hpp"
#include "publish/target.hpp"
#include "publish/vmc_bones.hpp"

namespace nendo::publish {

struct OscCounts : SenderCounts {
  std::uint64_t datagrams = 0; ///< that the system accepted
  std::uint64_t refused = 0;   ///< that the system did not accept; those are lost
  std::uint64_t bytes = 0;     ///< all bytes of the accepted datagrams
};

class OscPublisher final : public flow::FrameSink {
public:
  /// name: the target as the user wrote it, for error messages.
  OscPublisher(std::string name, const OscTarget& target)
      : name_(std::move(name)), format_(target.format), to_(target.endpoint.socket_address()),
        sender_(target.rate_hz) {}

  /// Begins to send. To be called before each loop's first tick, while no loop runs. The first call
  /// opens the socket. Errors: failed (no way to that address), no_permission.
  Result<void> begin(const LoopOutline& outline);
  /// Wait-free: no allocation, lock or system call.
  void show(const flow::Frame& frame) noexcept override { sender_.show(frame); }
  /// Sends the remaining records. To be called while no loop runs.
  void end() { sender_.end(); }

  /// Returns the counts. To be called after end().
  OscCounts counts() const noexcept;

private:
  Result<void> open();
  void send(const HandsRecord& record);
  void send_datagram(std::span<const std::byte> datagram) noexcept;

  std::string name_;
  OscFormat format_;
  SocketAddress to_;
  UniqueFd socket_;
  std::array<std::optional<VmcHand>, 2> avatar_; ///< left, right
  std::optional<std::int64_t> first_ns_;         ///< when the first record's tick woke
  OscCounts counts_;                             ///< the counts of datagrams
  HandsSender sender_; ///< the last member, because its thread uses the others
};

} // namespace nendo::publish
