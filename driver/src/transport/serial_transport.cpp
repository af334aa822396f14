// The two kinds of serial lines: real ports by libserialport, and pseudo-terminals by termios.

#include "transport/open_transport.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <optional>
#include <span>
#include <utility>

#include <fcntl.h>
#include <libserialport.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <nendo/base/unique_fd.hpp>
#include <nendo/base/units.hpp>

#include "transport/fd_io.hpp"

namespace nendo::driver {
namespace {

/// A pseudo-terminal carries bytes at any speed, but its other end sees the speed.
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
  explicit TermiosTransport(UniqueFd fd) noexcept : fd_(std::move(fd)) {}

  ReadResult read_some(std::span<std::byte> buffer,
                       std::chrono::milliseconds timeout) noexcept override {
    const IoStatus ready = wait_fd(fd_.get(), POLLIN, HostClock::now() + timeout);
    if (ready != IoStatus::done) return {ready, 0};
    const ssize_t count = ::read(fd_.get(), buffer.data(), buffer.size());
    if (count > 0) return {IoStatus::done, static_cast<std::size_t>(count)};
    const bool nothing_yet = count < 0 && (errno == EAGAIN || errno == EINTR);
    return {nothing_yet ? IoStatus::timeout : IoStatus::gone, 0};
  }

  IoStatus write_all(std::span<const std::byte> bytes,
                     std::chrono::milliseconds timeout) noexcept override {
    return write_all_fd(fd_.get(), bytes, timeout,
                        [this](std::span<const std::byte> rest) -> ssize_t {
                          const ssize_t count = ::write(fd_.get(), rest.data(), rest.size());
                          return count < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : count;
                        });
  }

  void discard_input() noexcept override { ::tcflush(fd_.get(), TCIFLUSH); }

  bool set_baud(int baud) noexcept override {
    const auto speed = speed_of(baud);
    termios settings{};
    return speed && ::tcgetattr(fd_.get(), &settings) == 0 &&
           ::cfsetspeed(&settings, *speed) == 0 && ::tcsetattr(fd_.get(), TCSANOW, &settings) == 0;
  }

private:
  const UniqueFd fd_;
};

/// Returns 0 or an error number.
int make_raw_and_lock(int fd) {
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) return errno;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CREAD | CLOCAL;
  settings.c_cc[VMIN] = 1; // so that "nothing yet" (EAGAIN) differs from "hung up" (0)
  settings.c_cc[VTIME] = 0;
  // Not TIOCEXCL: a pseudo-terminal would keep it after close, for as long as its other end stays
  // open.
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) return errno;
  if (::tcsetattr(fd, TCSANOW, &settings) != 0) return errno;
  return 0;
}

struct PortCloser {
  void operator()(sp_port* port) const noexcept { sp_free_port(port); }
};
using PortHandle = std::unique_ptr<sp_port, PortCloser>;

struct ConfigCloser {
  void operator()(sp_port_config* config) const noexcept { sp_free_config(config); }
};

/// Owns an open port.
class SerialportTransport final : public Transport {
public:
  SerialportTransport(PortHandle port, int fd) noexcept : port_(std::move(port)), fd_(fd) {}
  ~SerialportTransport() override {
    // Otherwise closing waits, half a minute by default, for bytes that a dead line will never
    // take.
    sp_flush(port_.get(), SP_BUF_BOTH);
    // A terminal that something else keeps alive would stay closed to all but root.
    ::ioctl(fd_, TIOCNXCL);
    sp_close(port_.get());
  }

  ReadResult read_some(std::span<std::byte> buffer,
                       std::chrono::milliseconds timeout) noexcept override {
    const IoStatus ready = wait_fd(fd_, POLLIN, HostClock::now() + timeout);
    if (ready != IoStatus::done) return {ready, 0};
    const int count = sp_nonblocking_read(port_.get(), buffer.data(), buffer.size());
    if (count > 0) return {IoStatus::done, static_cast<std::size_t>(count)};
    // An unplugged adapter is readable for ever and yields nothing; libserialport calls that "no
    // data".
    return {IoStatus::gone, 0};
  }

  IoStatus write_all(std::span<const std::byte> bytes,
                     std::chrono::milliseconds timeout) noexcept override {
    return write_all_fd(fd_, bytes, timeout, [this](std::span<const std::byte> rest) {
      const int count = sp_nonblocking_write(port_.get(), rest.data(), rest.size());
      // 0.1.1 reports a full output buffer as a failure.
      return count < 0 && sp_last_error_code() == EAGAIN ? 0 : static_cast<int>(count);
    });
  }

  void discard_input() noexcept override { sp_flush(port_.get(), SP_BUF_INPUT); }

  bool set_rts(bool high) noexcept override {
    return sp_set_rts(port_.get(), high ? SP_RTS_ON : SP_RTS_OFF) == SP_OK;
  }
  bool set_baud(int baud) noexcept override { return sp_set_baudrate(port_.get(), baud) == SP_OK; }

private:
  const PortHandle port_;
  const int fd_;
};

/// 8N1 without flow control; both modem lines asserted, never toggled (the 1990s interface unit may
/// be powered by or look at them; nothing documents it). Returns 0 or an error number.
int configure(sp_port* port, int baud) {
  sp_port_config* raw = nullptr;
  if (sp_new_config(&raw) != SP_OK) return ENOMEM;
  const std::unique_ptr<sp_port_config, ConfigCloser> config(raw);
  sp_set_config_baudrate(raw, baud);
  sp_set_config_bits(raw, 8);
  sp_set_config_parity(raw, SP_PARITY_NONE);
  sp_set_config_stopbits(raw, 1);
  sp_set_config_rts(raw, SP_RTS_ON);
  sp_set_config_cts(raw, SP_CTS_IGNORE);
  sp_set_config_dtr(raw, SP_DTR_ON);
  sp_set_config_dsr(raw, SP_DSR_IGNORE);
  sp_set_config_xon_xoff(raw, SP_XONXOFF_DISABLED); // 0x11 and 0x13 are sensor values
  return sp_set_config(port, raw) == SP_OK ? 0 : sp_last_error_code();
}

/// libserialport 0.1.1 lets two programs open one port. TIOCEXCL keeps others out, but not root;
/// the lock does.
int make_exclusive(int fd) {
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) return errno;
  return ::ioctl(fd, TIOCEXCL) == 0 ? 0 : errno;
}

int close_with(sp_port* port, int error_number) {
  sp_close(port);
  return error_number;
}

int open_port(sp_port* port, int baud, int& fd) {
  if (sp_open(port, SP_MODE_READ_WRITE) != SP_OK) return sp_last_error_code();
  if (sp_get_port_handle(port, &fd) != SP_OK) return close_with(port, EBADF);
  if (const int e = make_exclusive(fd); e != 0) return close_with(port, e);
  if (const int e = configure(port, baud); e != 0) return close_with(port, e);
  return 0;
}

} // namespace

std::unique_ptr<Transport> transport_of(int fd) {
  return std::make_unique<TermiosTransport>(UniqueFd(fd));
}

Result<std::unique_ptr<Transport>> open_termios(const std::string& path) {
  UniqueFd fd(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!fd.is_open()) return open_error(path, errno);
  if (const int e = make_raw_and_lock(fd.get()); e != 0) return open_error(path, e);
  return std::unique_ptr<Transport>(std::make_unique<TermiosTransport>(std::move(fd)));
}

Result<std::unique_ptr<Transport>> open_serialport(const std::string& path, int baud) {
  sp_port* raw = nullptr;
  if (sp_get_port_by_name(path.c_str(), &raw) != SP_OK) return open_error(path, ENODEV);
  PortHandle port(raw);
  int fd = -1;
  if (const int e = open_port(raw, baud, fd); e != 0) return open_error(path, e);
  return std::unique_ptr<Transport>(std::make_unique<SerialportTransport>(std::move(port), fd));
}

} // namespace nendo::driver
