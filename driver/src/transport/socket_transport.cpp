#include "transport/socket_transport.hpp"

#include <cerrno>
#include <chrono>
#include <span>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

#include <nendo/base/units.hpp>

#include "transport/fd_io.hpp"

namespace nendo::driver {
namespace {

class SocketTransport final : public Transport {
public:
  explicit SocketTransport(UniqueFd fd) noexcept : fd_(std::move(fd)) {}

  ReadResult read_some(std::span<std::byte> buffer,
                       std::chrono::milliseconds timeout) noexcept override {
    if (is_hung_up_) return {IoStatus::gone, 0};
    const IoStatus ready = wait_fd(fd_.get(), POLLIN, HostClock::now() + timeout);
    if (ready != IoStatus::done) return {ready, 0};
    const ssize_t count = ::recv(fd_.get(), buffer.data(), buffer.size(), 0);
    if (count > 0) return {IoStatus::done, static_cast<std::size_t>(count)};
    const bool nothing_yet = count < 0 && (errno == EAGAIN || errno == EINTR);
    return {nothing_yet ? IoStatus::timeout : IoStatus::gone, 0};
  }

  IoStatus write_all(std::span<const std::byte> bytes,
                     std::chrono::milliseconds timeout) noexcept override {
    if (is_hung_up_) return IoStatus::gone;
    return write_all_fd(
        fd_.get(), bytes, timeout, [this](std::span<const std::byte> rest) -> ssize_t {
          const ssize_t count = ::send(fd_.get(), rest.data(), rest.size(), MSG_NOSIGNAL);
          return count < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : count;
        });
  }

  void discard_input() noexcept override {}
  void hang_up() noexcept override {
    is_hung_up_ = true;
    ::shutdown(fd_.get(), SHUT_RDWR); // the server notices it before the reader does
  }

private:
  const UniqueFd fd_;
  bool is_hung_up_ = false;
};

} // namespace

std::unique_ptr<Transport> transport_of_socket(UniqueFd socket) {
  return std::make_unique<SocketTransport>(std::move(socket));
}

} // namespace nendo::driver
