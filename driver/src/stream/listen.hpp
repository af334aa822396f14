#pragma once
// For the dialogue of a protocol with its device: reading with a time limit.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include <nendo/base/units.hpp>

#include "stream/stream_protocol.hpp"
#include "transport/transport.hpp"

namespace nendo::driver {

/// Passes received bytes to `take(std::span<const std::byte>)` until that returns true (done), the
/// device is gone, or the time is over or `limit` is cancelled (timeout). Checks that every 0.1 s.
template <class Take>
IoStatus listen(Transport& transport, const ReplyDeadline& limit,
                std::chrono::milliseconds max_time, Take&& take) {
  constexpr std::chrono::milliseconds slice{100};
  std::array<std::byte, 1024> buffer;
  const HostTime until = std::min(limit.deadline, HostClock::now() + max_time);
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - HostClock::now());
    if (left.count() <= 0 || limit.cancelled.stop_requested()) return IoStatus::timeout;
    const auto [status, count] = transport.read_some(buffer, std::min(left, slice));
    if (status == IoStatus::gone) return IoStatus::gone;
    if (count > 0 && take(std::span<const std::byte>(buffer).first(count))) return IoStatus::done;
  }
}

/// Discards the bytes that have arrived, also those in the system's buffers; a pseudo-terminal
/// keeps some 17 kB. Does not wait. Returns the number of bytes read.
inline std::uint64_t drop_waiting(Transport& transport) noexcept {
  constexpr std::uint64_t max_bytes = 65'536; // a device may send faster than any host reads
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
