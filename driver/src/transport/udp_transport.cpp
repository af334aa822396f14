#include "transport/udp_transport.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <span>
#include <thread>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

#include <nendo/base/unique_fd.hpp>
#include <nendo/base/units.hpp>

namespace nendo::driver {
namespace {

using namespace std::chrono_literals;

constexpr auto rate_window_of_reads = 10ms;
constexpr int max_reads_per_window = max_datagrams_per_s / 100;

class UdpTransport final : public Transport {
public:
  explicit UdpTransport(UniqueFd socket) noexcept : socket_(std::move(socket)) {}

  ReadResult read_some(std::span<std::byte> buffer,
                       std::chrono::milliseconds timeout) noexcept override {
    const HostTime deadline = HostClock::now() + timeout;
    if (!await_window(deadline)) return {};
    pollfd entry{socket_.get(), POLLIN, 0};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - HostClock::now());
    if (::poll(&entry, 1, static_cast<int>(std::clamp<long>(left.count(), 0, 60'000))) <= 0)
      return {};
    const ssize_t count = receive(buffer);
    if (count > 0) return {IoStatus::done, static_cast<std::size_t>(count)};
    const bool none = count == 0 || errno == EAGAIN || errno == EINTR;
    return {none ? IoStatus::timeout : IoStatus::gone, 0};
  }

  IoStatus write_all(std::span<const std::byte> /*bytes*/,
                     std::chrono::milliseconds /*timeout*/) noexcept override {
    return IoStatus::timeout; // there is no one receiver
  }

  void discard_input() noexcept override {
    constexpr int max_datagrams = 4096; // more than the system's buffer holds
    std::byte first{};
    for (int count = 0; count < max_datagrams && receive(std::span(&first, 1)) >= 0; ++count) {
    }
  }

private:
  ssize_t receive(std::span<std::byte> buffer) const noexcept {
    return ::recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  }

  /// Waits until the rate allows another read. Returns false if that is after `deadline`.
  bool await_window(HostTime deadline) noexcept {
    HostTime now = HostClock::now();
    if (now - window_begin_ < rate_window_of_reads && reads_in_window_ == max_reads_per_window) {
      const HostTime end = window_begin_ + rate_window_of_reads;
      std::this_thread::sleep_until(std::min(end, deadline));
      if (end > deadline) return false;
      now = HostClock::now();
    }
    if (now - window_begin_ >= rate_window_of_reads) {
      window_begin_ = now;
      reads_in_window_ = 0;
    }
    ++reads_in_window_;
    return true;
  }

  const UniqueFd socket_;
  HostTime window_begin_{};
  int reads_in_window_ = 0;
};

} // namespace

Result<std::unique_ptr<Transport>> open_udp(Endpoint endpoint) {
  auto socket = open_at(endpoint, SOCK_DGRAM);
  if (socket) return std::unique_ptr<Transport>(std::make_unique<UdpTransport>(*std::move(socket)));
  const bool may_not = socket.error().code == Errc::no_permission;
  return Error{may_not ? Errc::no_permission : Errc::no_device, "port " + socket.error().message};
}

} // namespace nendo::driver
