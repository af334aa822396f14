#pragma once
// An emulator that is being served, and a very simple host at its terminal.

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include <nendo/base/units.hpp>
#include <nendo/emulator/emulator.hpp>

#include "support/required.hpp"

namespace nendo::test {

/// Serves an emulator from a thread of its own until stop() or the destructor.
class ServedEmulator {
public:
  explicit ServedEmulator(const emulator::EmulatorOptions& options = {}) {
    emulator_ = required(emulator::DeviceEmulator::open(options));
    thread_ = std::thread([this] { good_ = static_cast<bool>(emulator_->serve(stop_)); });
  }
  ServedEmulator(const ServedEmulator&) = delete;
  ServedEmulator& operator=(const ServedEmulator&) = delete;
  ~ServedEmulator() { stop(); }

  void stop() {
    if (!thread_.joinable()) return;
    stop_ = true;
    thread_.join();
    CHECK(good_);
  }
  const emulator::DeviceEmulator* operator->() const { return emulator_.get(); }

private:
  std::unique_ptr<emulator::DeviceEmulator> emulator_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> good_{false};
  std::thread thread_;
};

/// A host that opens the terminal, sets raw mode, reads and writes.
class PtyHost {
public:
  explicit PtyHost(const std::string& path)
      : fd_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    REQUIRE(fd_ >= 0);
    termios line{};
    REQUIRE(::tcgetattr(fd_, &line) == 0);
    ::cfmakeraw(&line);
    REQUIRE(::tcsetattr(fd_, TCSANOW, &line) == 0);
  }
  PtyHost(const PtyHost&) = delete;
  PtyHost& operator=(const PtyHost&) = delete;
  ~PtyHost() { ::close(fd_); }

  void send(std::string_view bytes) {
    REQUIRE(::write(fd_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  }
  /// Reads until `enough(bytes)`, the terminal is gone, or ten seconds are over.
  template <class Enough>
  std::string receive_until(Enough&& enough) {
    std::string bytes;
    const auto deadline = HostClock::now() + std::chrono::seconds(10);
    while (!gone_ && !enough(bytes) && HostClock::now() < deadline)
      read_some(bytes, std::chrono::milliseconds(50));
    return bytes;
  }
  /// Reads at least `size` bytes, or fewer if they do not come within ten seconds.
  std::string receive(std::size_t size) {
    return receive_until([size](const std::string& bytes) { return bytes.size() >= size; });
  }
  /// Reads until nothing has come for so long.
  std::string drain(std::chrono::milliseconds quiet = std::chrono::milliseconds(100)) {
    std::string bytes;
    while (read_some(bytes, quiet)) {
    }
    return bytes;
  }
  bool gone() const { return gone_; }

private:
  bool read_some(std::string& bytes, std::chrono::milliseconds longest) {
    pollfd line{fd_, POLLIN, 0};
    if (::poll(&line, 1, static_cast<int>(longest.count())) <= 0) return false;
    const std::size_t before = bytes.size();
    bytes.resize(before + 65536);
    const ssize_t count = ::read(fd_, bytes.data() + before, 65536);
    bytes.resize(before + static_cast<std::size_t>(count > 0 ? count : 0));
    gone_ = count <= 0;
    return count > 0;
  }

  int fd_;
  bool gone_ = false;
};

} // namespace nendo::test
