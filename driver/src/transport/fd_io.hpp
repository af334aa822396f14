#pragma once
// Waiting for file descriptors and writing to them with a time limit, for the transports.

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <span>

#include <poll.h>

#include <nendo/base/units.hpp>

#include "transport/transport.hpp"

namespace nendo::driver {

/// Waits until `fd` is ready for `events` (POLLIN or POLLOUT). Bytes that arrived before a hang-up
/// can still be read, so readiness is reported before `gone`.
inline IoStatus wait_fd(int fd, short events, HostTime deadline) noexcept {
  using std::chrono::milliseconds;
  for (;;) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - HostClock::now());
    pollfd entry{fd, events, 0};
    const int ready =
        ::poll(&entry, 1, static_cast<int>(std::clamp<long>(left.count(), 0, 60'000)));
    if (ready == 0) return IoStatus::timeout;
    if (ready > 0) return (entry.revents & events) != 0 ? IoStatus::done : IoStatus::gone;
    if (errno != EINTR) return IoStatus::gone;
  }
}

/// Writes all bytes. `write_now(bytes)` must return how many bytes the descriptor took, 0 if it
/// takes none now, or a negative number if it is gone.
template <class WriteNow>
IoStatus write_all_fd(int fd, std::span<const std::byte> bytes, std::chrono::milliseconds timeout,
                      WriteNow&& write_now) noexcept {
  const HostTime deadline = HostClock::now() + timeout;
  while (!bytes.empty()) {
    const IoStatus ready = wait_fd(fd, POLLOUT, deadline);
    if (ready != IoStatus::done) return ready;
    const auto written = write_now(bytes);
    if (written < 0) return IoStatus::gone;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    if (!bytes.empty() && HostClock::now() >= deadline) return IoStatus::timeout;
  }
  return IoStatus::done;
}

} // namespace nendo::driver
