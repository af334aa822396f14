#pragma once
// Listens to a device for a while, as it is needed to identify a glove.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include <nendo/base/units.hpp>

#include "stream/glove_protocol.hpp"
#include "transport/transport.hpp"

namespace nendo::driver {

/// Hands what arrives to `take(std::span<const std::byte>)` until that returns true (done), the
/// device is gone, or the deadline has passed or listening is cancelled (timeout). Checks for that
/// every 0.1 s.
template <class Take>
IoStatus listen(Transport& transport, const ReplyDeadline& patience,
                std::chrono::milliseconds longest, Take&& take) {
  constexpr std::chrono::milliseconds slice{100};
  std::array<std::byte, 256> buffer;
  const HostTime until = std::min(patience.deadline, HostClock::now() + longest);
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - HostClock::now());
    if (left.count() <= 0 || patience.cancelled.stop_requested()) return IoStatus::timeout;
    const auto [status, count] = transport.read_some(buffer, std::min(left, slice));
    if (status == IoStatus::gone) return IoStatus::gone;
    if (count > 0 && take(std::span<const std::byte>(buffer).first(count))) return IoStatus::done;
  }
}

/// Throws away what has arrived, also what the system holds back; a pseudo-terminal keeps some 17
/// kB that no host has read. Does not wait. Returns how many bytes it read.
inline std::uint64_t drop_waiting(Transport& transport) noexcept {
  constexpr std::uint64_t max_bytes = 65'536; // a device that babbles may outrun any host
  std::array<std::byte, 1024> buffer;
  transport.discard_input();
  std::uint64_t dropped = 0;
  while (dropped < max_bytes) {
    const auto [status, count] = transport.read_some(buffer, std::chrono::milliseconds(0));
    if (status != IoStatus::done) break;
    dropped += count;
  }
  return dropped;
}

} // namespace nendo::driver
