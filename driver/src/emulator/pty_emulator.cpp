#include <nendo/driver/emulator.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <nendo/base/units.hpp>

#include "emulator/cyberglove_unit.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr HostClock::duration longest_wait = 20ms; // how late `stop` may be seen

std::string text_of(int error) {
  return std::generic_category().message(error);
}

class FileDescriptor {
public:
  explicit FileDescriptor(int fd) noexcept : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&&) = delete;
  ~FileDescriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const noexcept { return fd_; }

private:
  int fd_;
};

// A symbolic link that is gone when its maker is, unless someone has pointed it elsewhere
// meanwhile.
class Link {
public:
  Link() = default;
  Link(fs::path path, std::string target) : path_(std::move(path)), target_(std::move(target)) {}
  Link(Link&& other) noexcept
      : path_(std::exchange(other.path_, {})), target_(std::move(other.target_)) {}
  Link& operator=(Link&&) = delete;
  ~Link() {
    if (path_.empty()) return;
    std::error_code error;
    if (fs::read_symlink(path_, error) == target_ && !error) fs::remove(path_, error);
  }

  // Replaces an old link in one step, so that a host sees the old terminal or the new one, and
  // refuses to replace anything else.
  static Result<Link> make(const std::string& where, const std::string& target) {
    const auto failed = [&where](const std::string& why) {
      return Error{Errc::failed, where + ": cannot make the link: " + why};
    };
    std::error_code error;
    const fs::path path = fs::absolute(where, error);
    if (error) return failed(error.message());
    if (!fs::is_directory(path.parent_path(), error)) {
      return failed("there is no folder " + path.parent_path().string());
    }
    const fs::file_status old = fs::symlink_status(path, error);
    if (fs::exists(old) && !fs::is_symlink(old)) {
      return failed(
          "its place is taken by something that is not a link; remove that or choose another path");
    }
    const fs::path temporary = path.string() + "." + std::to_string(::getpid());
    fs::create_symlink(target, temporary, error);
    if (error) return failed(error.message());
    fs::rename(temporary, path, error);
    if (error) {
      const std::string why = error.message();
      fs::remove(temporary, error);
      return failed(why);
    }
    return Link(path, target);
  }

private:
  fs::path path_;
  std::string target_;
};

class PtyEmulator final : public GloveEmulator {
public:
  PtyEmulator(FileDescriptor master, std::string tty_path, Link link, const UnitOptions& options)
      : master_(std::move(master)), tty_path_(std::move(tty_path)), link_(std::move(link)),
        unit_(options) {}

  const std::string& tty_path() const noexcept override { return tty_path_; }

  Result<void> serve(const std::atomic<bool>& stop) override {
    while (!stop) {
      unit_.advance(now());
      flush();
      if (auto waited = wait(); !waited) return waited;
    }
    return {};
  }

  EmulatorStats stats() const noexcept override {
    return {received_.load(std::memory_order_relaxed), sent_.load(std::memory_order_relaxed),
            records_.load(std::memory_order_relaxed), refused_.load(std::memory_order_relaxed)};
  }

private:
  CyberGloveUnit::Time now() const noexcept { return HostClock::now() - switched_on_; }

  // Until a host writes, or the unit has something to do, or it is time to look at `stop`.
  Result<void> wait() {
    const auto latest = now() + longest_wait;
    const auto until = std::min(latest, unit_.next_due().value_or(latest));
    const auto left = std::max(until - now(), 0ns);
    const timespec timeout{0, static_cast<long>(std::min<std::int64_t>(left.count(), 999'999'999))};
    pollfd line{master_.get(), POLLIN, 0};
    if (::ppoll(&line, 1, &timeout, nullptr) < 0 && errno != EINTR) {
      return Error{Errc::failed, tty_path_ + ": poll: " + text_of(errno)};
    }
    if ((line.revents & POLLIN) != 0) {
      host_present_ = true;
      return receive();
    }
    host_present_ = (line.revents & POLLHUP) == 0;
    // Nobody has the terminal open: poll() then returns at once, for ever, and must not make this
    // loop spin.
    if (!host_present_) std::this_thread::sleep_until(switched_on_ + until);
    return {};
  }

  Result<void> receive() {
    std::array<std::byte, 256> bytes;
    const ssize_t count = ::read(master_.get(), bytes.data(), bytes.size());
    if (count > 0) {
      const auto size = static_cast<std::size_t>(count);
      received_.fetch_add(size, std::memory_order_relaxed);
      unit_.receive(std::span(bytes).first(size), now());
      return {};
    }
    // EIO: the host has closed the terminal. There will be another.
    if (count == 0 || errno == EAGAIN || errno == EINTR || errno == EIO) return {};
    return Error{Errc::failed, tty_path_ + ": read: " + text_of(errno)};
  }

  // Whatever the terminal does not take now waits in the unit, which refuses whole messages when it
  // is full. With nobody at the other end the bytes are lost, as on a cable that ends in the air.
  void flush() {
    const auto waiting = unit_.output();
    if (!host_present_) {
      lost_ += waiting.size();
      unit_.take(waiting.size());
    } else if (!waiting.empty()) {
      const ssize_t count = ::write(master_.get(), waiting.data(), waiting.size());
      if (count > 0) {
        sent_.fetch_add(static_cast<std::uint64_t>(count), std::memory_order_relaxed);
        unit_.take(static_cast<std::size_t>(count));
      }
    }
    records_.store(unit_.counters().records, std::memory_order_relaxed);
    refused_.store(unit_.counters().bytes_refused + lost_, std::memory_order_relaxed);
  }

  FileDescriptor master_;
  std::string tty_path_;
  Link link_;
  CyberGloveUnit unit_;
  HostTime switched_on_ = HostClock::now();
  bool host_present_ = false;
  std::uint64_t lost_ = 0; ///< bytes that came out while no host was there
  std::atomic<std::uint64_t> received_{0};
  std::atomic<std::uint64_t> sent_{0};
  std::atomic<std::uint64_t> records_{0};
  std::atomic<std::uint64_t> refused_{0};
};

Result<UnitOptions> unit_options(const EmulatorOptions& options) {
  const auto motion = find_motion(options.motion);
  if (!motion) return motion.error();
  if (options.sensors != 18 && options.sensors != 22) {
    return Error{Errc::usage,
                 "a CyberGlove has 18 or 22 sensors, not " + std::to_string(options.sensors)};
  }
  if (!(options.rate_hz >= 1.0 && options.rate_hz <= CyberGloveUnit::most_rate_hz)) {
    return Error{Errc::usage,
                 "the rate must be from 1 to 480 records a second (what 115200 baud can carry)"};
  }
  return UnitOptions{options.side, options.sensors, *motion, options.rate_hz, options.seed};
}

} // namespace

Result<std::unique_ptr<GloveEmulator>> GloveEmulator::open(const EmulatorOptions& options) {
  const auto unit = unit_options(options);
  if (!unit) return unit.error();
  const auto failed = [] {
    return Error{Errc::failed, "cannot make a pseudo-terminal: " + text_of(errno)};
  };

  FileDescriptor master(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 64> name{};
  termios raw{};
  if (master.get() < 0 || ::grantpt(master.get()) != 0 || ::unlockpt(master.get()) != 0 ||
      ::ptsname_r(master.get(), name.data(), name.size()) != 0 ||
      ::tcgetattr(master.get(), &raw) != 0) {
    return failed();
  }
  ::cfmakeraw(&raw);
  ::cfsetspeed(&raw, B115200);
  if (::tcsetattr(master.get(), TCSANOW, &raw) != 0) return failed();
  // Only a terminal that was opened once tells poll() that nobody has it open.
  { const FileDescriptor once(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC)); }

  const std::string tty_path = name.data();
  Result<Link> link =
      options.link.empty() ? Result<Link>(Link()) : Link::make(options.link, tty_path);
  if (!link) return link.error();
  return std::unique_ptr<GloveEmulator>(
      std::make_unique<PtyEmulator>(std::move(master), tty_path, *std::move(link), *unit));
}

} // namespace nendo::driver
