#include "transport/open_transport.hpp"

#include <array>
#include <cerrno>
#include <optional>

#include <fcntl.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include "transport/wait_fd.hpp"

namespace nendo::driver {
namespace {

/// A pseudo-terminal carries bytes at any speed, but whoever is at its other end sees which is set.
std::optional<speed_t> speed_of(int baud) noexcept {
  struct Known {
    int baud;
    speed_t speed;
  };
  constexpr std::array all{Known{115'200, B115200}, Known{57'600, B57600}, Known{38'400, B38400},
                           Known{19'200, B19200}, Known{9'600, B9600}};
  for (const Known& known : all) {
    if (known.baud == baud) return known.speed;
  }
  return std::nullopt;
}

class TermiosTransport final : public Transport {
public:
  explicit TermiosTransport(int fd) noexcept : fd_(fd) {}
  ~TermiosTransport() override { ::close(fd_); }

  ReadResult read_some(std::span<std::byte> buffer,
                       std::chrono::milliseconds timeout) noexcept override {
    const IoStatus ready = wait_fd(fd_, POLLIN, HostClock::now() + timeout);
    if (ready != IoStatus::done) return {ready, 0};
    const ssize_t count = ::read(fd_, buffer.data(), buffer.size());
    if (count > 0) return {IoStatus::done, static_cast<std::size_t>(count)};
    const bool nothing_yet = count < 0 && (errno == EAGAIN || errno == EINTR);
    return {nothing_yet ? IoStatus::timeout : IoStatus::gone, 0};
  }

  IoStatus write_all(std::span<const std::byte> bytes,
                     std::chrono::milliseconds timeout) noexcept override {
    return write_all_fd(fd_, bytes, timeout, [this](std::span<const std::byte> rest) -> ssize_t {
      const ssize_t count = ::write(fd_, rest.data(), rest.size());
      return count < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : count;
    });
  }

  void discard_input() noexcept override { ::tcflush(fd_, TCIFLUSH); }

  bool set_baud(int baud) noexcept override {
    const auto speed = speed_of(baud);
    termios settings{};
    return speed && ::tcgetattr(fd_, &settings) == 0 && ::cfsetspeed(&settings, *speed) == 0 &&
           ::tcsetattr(fd_, TCSANOW, &settings) == 0;
  }

private:
  const int fd_;
};

/// Returns 0 or an error number.
int make_raw_and_lock(int fd) {
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) return errno;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CREAD | CLOCAL;
  settings.c_cc[VMIN] = 1; // so that read() tells "nothing yet" (EAGAIN) from "hung up" (0)
  settings.c_cc[VTIME] = 0;
  // Not TIOCEXCL: a pseudo-terminal would keep it after close, for as long as its other end stays
  // open.
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) return errno;
  if (::tcsetattr(fd, TCSANOW, &settings) != 0) return errno;
  return 0;
}

} // namespace

std::unique_ptr<Transport> transport_of(int fd) {
  return std::make_unique<TermiosTransport>(fd);
}

Result<std::unique_ptr<Transport>> open_termios(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return open_error(path, errno);
  if (const int error_number = make_raw_and_lock(fd); error_number != 0) {
    ::close(fd);
    return open_error(path, error_number);
  }
  return transport_of(fd);
}

} // namespace nendo::driver
