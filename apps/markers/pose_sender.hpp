#pragma once
// Sends poses to the OSC inlet of a run, which is `nendo run --left-wrist osc:9000/left`.

#include <chrono>
#include <string>
#include <string_view>

#include <nendo/base/endpoint.hpp>
#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>
#include <nendo/base/unique_fd.hpp>

#include "markers/bracelet_pose.hpp"

namespace nendo::markers {

/// Returns a packet of OSC 1.0: a bundle with the time of the picture, and in it a message to
/// /nendo/wrist/left|right with seven doubles.
std::string pose_packet(Side side, const StagePose& pose,
                        std::chrono::system_clock::time_point time);

class PoseSender {
public:
  /// `to` is an endpoint, see parse_endpoint(). Errors: usage; failed (no socket).
  static Result<PoseSender> open(std::string_view to);
  /// Sends one datagram. One that the system refuses is lost.
  void send(const std::string& packet) const noexcept;

private:
  UniqueFd socket_;
  SocketAddress to_;
};

} // namespace nendo::markers
