#include "bench/latency_probe.hpp"

#include <array>
#include <cstdlib>
#include <optional>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <nendo/base/unique_fd.hpp>

#include "bench/two_threads.hpp"
#include "cyberglove/cyberglove_driver.hpp"
#include "transport/open_transport.hpp"
#include "units/cyberglove_unit.hpp"

namespace nendo::bench {
namespace {

using emulator::CyberGloveUnit;
using namespace std::chrono_literals;

struct Wire {
  UniqueFd device;
  UniqueFd host;
};

Result<Wire> make_wire(Line line) {
  const Error none{Errc::failed, "cannot make a pseudo-terminal or socket pair to measure over"};
  if (line == Line::socket_pair) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0)
      return none;
    return Wire{UniqueFd(ends[0]), UniqueFd(ends[1])};
  }
  constexpr int flags = O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC;
  UniqueFd device(::posix_openpt(flags));
  std::array<char, 64> name{};
  const int fd = device.get();
  if (fd < 0 || ::grantpt(fd) != 0 || ::unlockpt(fd) != 0 ||
      ::ptsname_r(fd, name.data(), name.size()) != 0) {
    return none;
  }
  UniqueFd host(::open(name.data(), flags));
  termios settings{};
  if (!host.is_open() || ::tcgetattr(host.get(), &settings) != 0) return none;
  ::cfmakeraw(&settings);
  if (::tcsetattr(host.get(), TCSANOW, &settings) != 0) return none;
  return Wire{std::move(device), std::move(host)};
}

emulator::UnitOptions at_rate(double rate_hz) {
  emulator::UnitOptions options;
  options.rate_hz = rate_hz;
  return options;
}

bool write_record(int fd, std::span<const std::byte> bytes) {
  return ::write(fd, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
}

/// Writes a record and returns the time until `ring` shows a sample, or nothing if it does not
/// within a second.
std::optional<HostClock::duration> time_one(SampleRing& ring, int fd,
                                            std::span<const std::byte> record) {
  const HostTime written = HostClock::now();
  if (!write_record(fd, record)) return std::nullopt;
  GloveSample sample;
  for (;;) {
    if (try_pop_or_pause(ring, sample)) return HostClock::now() - written;
    if (HostClock::now() - written > 1s) return std::nullopt;
  }
}

/// Reads records with as little work as possible. The driver is compared with it.
void read_barely(const std::stop_token& stop, int fd, SampleRing& ring) {
  std::array<char, 1024> buffer{};
  while (!stop.stop_requested()) {
    pollfd entry{fd, POLLIN, 0};
    if (::poll(&entry, 1, 100) <= 0) continue;
    const ssize_t count = ::read(fd, buffer.data(), buffer.size());
    if (count <= 0 || buffer[static_cast<std::size_t>(count - 1)] != 0) continue;
    GloveSample sample;
    sample.arrival = HostClock::now();
    ring.try_push(sample); // never full: the next record is written when this one was taken
  }
}

/// The device's end of the driver's line. Serves the dialogue while the glove is opened; then
/// writes a record to either line in turn.
class Device {
public:
  Device(const LatencyOptions& options, int driver_fd, int bare_fd)
      : options_(options), unit_(at_rate(options.rate_hz)), driver_fd_(driver_fd),
        bare_fd_(bare_fd) {}

  void serve_dialogue(const std::atomic<bool>& opened) {
    while (!opened)
      serve();
    // The command that starts the stream may still be on its way.
    for (const HostTime until = HostClock::now() + 1s;
         !unit_.next_due() && HostClock::now() < until;)
      serve();
  }

  /// Returns false if a record got lost.
  bool measure(SampleRing& driver_ring, SampleRing& bare_ring, const LatencySinks& sinks,
               const std::atomic<bool>& stop) {
    std::size_t warm_up = options_.records / 20 + 1;
    for (std::size_t k = 0; k < options_.records + warm_up && !stop;) {
      if (!prepare_record()) return false;
      const auto bytes = unit_.output();
      std::optional<HostClock::duration> driver;
      std::optional<HostClock::duration> bare;
      const auto time_driver = [&] { driver = time_one(driver_ring, driver_fd_, bytes); };
      const auto time_bare = [&] { bare = time_one(bare_ring, bare_fd_, bytes); };
      // The two take turns, because the second one finds the machine awake.
      k % 2 == 0 ? (time_driver(), time_bare()) : (time_bare(), time_driver());
      unit_.take(bytes.size());
      if (!driver || !bare) return false;
      if (k++ < warm_up) continue;
      sinks.driver(*driver);
      sinks.bare(*bare);
    }
    return true;
  }

private:
  void serve() {
    std::array<std::byte, 256> buffer{};
    pollfd entry{driver_fd_, POLLIN, 0};
    const bool readable = ::poll(&entry, 1, 1) > 0 && (entry.revents & POLLIN) != 0;
    const ssize_t count = readable ? ::read(driver_fd_, buffer.data(), buffer.size()) : 0;
    if (count > 0) unit_.receive(std::span(buffer).first(static_cast<std::size_t>(count)), now());
    unit_.advance(now());
    if (!unit_.output().empty() && write_record(driver_fd_, unit_.output()))
      unit_.take(unit_.output().size());
  }

  CyberGloveUnit::Time now() const noexcept { return HostClock::now() - switched_on_; }

  bool prepare_record() {
    while (unit_.output().empty()) {
      const auto due = unit_.next_due();
      if (!due) return false; // it does not stream
      std::this_thread::sleep_until(switched_on_ + *due);
      unit_.advance(*due); // one record, also when this thread is late
    }
    return true;
  }

  const LatencyOptions options_;
  const HostTime switched_on_ = HostClock::now();
  CyberGloveUnit unit_;
  const int driver_fd_;
  const int bare_fd_;
};

} // namespace

Result<void> measure_latency(const LatencyOptions& options, const LatencySinks& sinks,
                             const std::atomic<bool>& stop) {
  if (!(options.rate_hz >= 1.0 && options.rate_hz <= CyberGloveUnit::max_rate_hz)) {
    return Error{Errc::usage, "--rate: use 1 to 480 records per second"};
  }
  auto driver_wire = make_wire(options.line);
  if (!driver_wire) return driver_wire.error();
  auto bare_wire = make_wire(options.line);
  if (!bare_wire) return bare_wire.error();

  SampleRing driver_ring(1024);
  SampleRing bare_ring(1024);
  Device device(options, driver_wire->device.get(), bare_wire->device.get());
  std::atomic<bool> opened{false};
  std::thread dialogue([&] { device.serve_dialogue(opened); });
  const auto open_port = [&]() -> Result<std::unique_ptr<driver::Transport>> {
    UniqueFd host = std::move(driver_wire->host); // the transport gets a duplicate
    const int fd = host.is_open() ? ::fcntl(host.get(), F_DUPFD_CLOEXEC, 0) : -1;
    if (fd < 0) return Error{Errc::no_device, "the line was closed"};
    return driver::transport_of(fd);
  };
  auto glove = driver::cyberglove::open_cyberglove("latency", open_port, {},
                                                   HostClock::now() + driver::open_budget);
  const auto started = glove ? (*glove)->start(driver_ring) : Result<void>(glove.error());
  opened = true;
  dialogue.join();
  if (!started) return started.error();

  std::this_thread::sleep_for(50ms); // what the dialogue's thread sent last is on its way
  GloveSample early;
  while (driver_ring.try_pop(early)) {
  }
  const std::jthread bare(
      [&](const std::stop_token& token) { read_barely(token, bare_wire->host.get(), bare_ring); });
  if (!device.measure(driver_ring, bare_ring, sinks, stop)) {
    return Error{Errc::failed,
                 "a record did not arrive within a second; stop other programs and try again"};
  }
  return {};
}

} // namespace nendo::bench
