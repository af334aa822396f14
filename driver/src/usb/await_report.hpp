#pragma once
// Finds out whether a glove is there, because the receiver of a wireless glove answers even if the
// glove is switched off.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>

#include "stream/glove_protocol.hpp"
#include "transport/usb_transport.hpp"

namespace nendo::driver {

/// Reads until `good(report)` is true of a report, for 2 s at most, and counts the bytes in
/// `bytes`. Error: no_device.
template <class Good>
Result<void> await_report(Transport& transport, const std::string& source,
                          const ReplyDeadline& patience, std::uint64_t& bytes, Good&& good) {
  using namespace std::chrono_literals;
  std::array<std::byte, max_usb_report_bytes> buffer{};
  const HostTime deadline = std::min(patience.deadline, HostClock::now() + 2s);
  bool babbles = false;
  while (HostClock::now() < deadline && !patience.cancelled.stop_requested()) {
    const auto [status, count] = transport.read_some(buffer, 100ms);
    if (status == IoStatus::gone) return went_away(source);
    bytes += count;
    if (status != IoStatus::done) continue;
    if (good(std::span<const std::byte>(buffer).first(count))) return {};
    babbles = true;
  }
  return Error{Errc::no_device,
               source + (babbles ? " does not send what such a glove sends; is it another device?"
                                 : " sends nothing; is the glove switched on, and plugged into its "
                                   "receiver?")};
}

} // namespace nendo::driver
