#pragma once
// Sends hands as a VRPN server (VRPN.md), on a thread of its own.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <nendo/flow/frame.hpp>

#include "publish/frame_record.hpp"
#include "publish/hands_sender.hpp"
#include "publish/target.hpp"
#include "publish/vrpn_server.hpp"

namespace nendo::publish {

struct VrpnCounts : SenderCounts, vrpn::ServerCounts {};

class VrpnPublisher final : public flow::FrameSink {
public:
  /// name: the target as the user wrote it, for error messages.
  VrpnPublisher(std::string name, const VrpnTarget& target)
      : name_(std::move(name)), endpoint_(target.endpoint), sender_(target.rate_hz) {}

  /// Begins to send. To be called before each loop's first tick, while no loop runs. The first call
  /// opens the port, and clients stay from loop to loop. Hands need nothing of the outline. Errors:
  /// those of open_at().
  Result<void> begin(const LoopOutline& outline);
  /// Wait-free: no allocation, lock or system call.
  void show(const flow::Frame& frame) noexcept override { sender_.show(frame); }
  /// Sends the remaining records. To be called while no loop runs.
  void end() { sender_.end(); }

  /// Returns the counts. To be called after end().
  VrpnCounts counts() const;

private:
  std::string name_;
  Endpoint endpoint_;
  std::optional<vrpn::Server> server_;
  HandsSender sender_; ///< the last member, because its thread uses the others
};

} // namespace nendo::publish
