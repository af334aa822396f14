#pragma once
// Serves an EmulatedUnit on a pseudo-terminal, and two units that are no gloves.

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "units/emulated_unit.hpp"

namespace nendo::test {

class PtyUnit {
public:
  explicit PtyUnit(std::unique_ptr<emulator::EmulatedUnit> unit)
      : unit_(std::move(unit)), master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    char name[128] = {};
    if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
        ::ptsname_r(master_, name, sizeof name) != 0) {
      throw std::runtime_error("no pseudo-terminal");
    }
    path_ = name;
    slave_ = ::open(name, O_RDWR | O_NOCTTY); // kept, so that the terminal lives between two hosts
    termios settings{};
    ::tcgetattr(slave_, &settings);
    ::cfmakeraw(&settings);
    ::tcsetattr(slave_, TCSANOW, &settings);
    thread_ = std::thread([this] { serve(); });
  }
  ~PtyUnit() { unplug(); }
  PtyUnit(const PtyUnit&) = delete;
  PtyUnit& operator=(const PtyUnit&) = delete;

  const std::string& path() const { return path_; }
  /// Removes the device. The host's end hangs up.
  void unplug() {
    if (!thread_.joinable()) return;
    stop_ = true;
    thread_.join();
    ::close(slave_);
    ::close(master_);
  }
  /// Calls `look` with the unit while it serves. The caller must know the unit's class.
  template <class Unit, class Look>
  auto look(Look&& look) {
    const std::lock_guard lock(mutex_);
    return look(static_cast<const Unit&>(*unit_));
  }

  std::atomic<bool> mute{false}; // while true, nothing that the unit sends gets through

private:
  void serve() {
    using namespace std::chrono_literals;
    const auto switched_on = std::chrono::steady_clock::now();
    while (!stop_) {
      pollfd entry{master_, POLLIN, 0};
      std::array<std::byte, 256> buffer;
      const bool readable = ::poll(&entry, 1, 2) > 0 && (entry.revents & POLLIN) != 0;
      const ssize_t count = readable ? ::read(master_, buffer.data(), buffer.size()) : 0;
      const std::lock_guard lock(mutex_);
      const auto now = std::chrono::steady_clock::now() - switched_on;
      if (count > 0) unit_->receive(std::span(buffer).first(static_cast<std::size_t>(count)), now);
      unit_->advance(now);
      const auto output = unit_->output();
      const ssize_t sent = mute ? static_cast<ssize_t>(output.size())
                                : ::write(master_, output.data(), output.size());
      if (sent > 0) unit_->take(static_cast<std::size_t>(sent));
    }
  }

  std::mutex mutex_; // guards unit_
  const std::unique_ptr<emulator::EmulatedUnit> unit_;
  int master_ = -1;
  int slave_ = -1;
  std::string path_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// A unit that never sends anything, or always the same noise.
class Stranger final : public emulator::EmulatedUnit {
public:
  explicit Stranger(std::string_view noise) : noise_(noise) {}
  void receive(std::span<const std::byte> /*bytes*/, Time /*now*/) override {}
  void advance(Time /*now*/) override { send(std::as_bytes(std::span(noise_))); }
  std::optional<Time> next_due() const noexcept override { return std::nullopt; }

private:
  const std::string noise_;
};

} // namespace nendo::test
