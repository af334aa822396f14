#pragma once
// A ScriptedUnit, or a stranger device, at the far end of a pseudo-terminal.

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "support/scripted_unit.hpp"

namespace nendo::test {

/// The state that a test changes and looks at while the unit works.
struct ScriptControl {
  std::atomic<bool> unplugged{false};   // the glove from its interface unit
  std::atomic<bool> power_cycle{false}; // forgets everything, once

  void hear(std::string_view commands) {
    const std::lock_guard lock(mutex_);
    heard_ += commands;
  }
  /// Returns every command so far, also those before a power cycle.
  std::string heard() const {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

private:
  mutable std::mutex mutex_;
  std::string heard_;
};

/// Returns the speed in baud to which the host has set a pseudo-terminal.
inline unsigned host_baud(int fd) {
  termios settings{};
  ::tcgetattr(fd, &settings);
  switch (::cfgetospeed(&settings)) {
  case B115200:
    return 115200;
  case B38400:
    return 38400;
  case B19200:
    return 19200;
  case B9600:
    return 9600;
  default:
    return 0;
  }
}

/// Serves a ScriptedUnit on any file descriptor until told to stop. It sends a record every 2 ms
/// while it streams, and none while it is mute.
inline void serve_script(int fd, const Script& script, const std::atomic<bool>& stop,
                         const std::atomic<bool>& mute, ScriptControl& control) {
  std::optional<ScriptedUnit> unit(std::in_place, script);
  const auto send = [fd](std::string_view bytes) {
    // If the host does not read, bytes are lost, as on a wire.
    [[maybe_unused]] const ssize_t sent = ::write(fd, bytes.data(), bytes.size());
  };
  send(script.waiting);
  while (!stop) {
    pollfd entry{fd, POLLIN, 0};
    char buffer[256];
    const bool readable = ::poll(&entry, 1, 2) > 0 && (entry.revents & POLLIN) != 0;
    const ssize_t count = readable ? ::read(fd, buffer, sizeof buffer) : 0;
    if (script.manner == Manner::babbling) send("x7 noise \x01\x02");
    if (script.manner == Manner::modem && count > 0) send("\r\nERROR\r\n");
    if (script.manner != Manner::good && script.manner != Manner::no_glove) continue;
    if (control.power_cycle.exchange(false)) unit.emplace(script);
    unit->unplugged = control.unplugged;
    if (script.baud != 0 && host_baud(fd) != script.baud) continue;
    std::string input =
        unit->held + std::string(buffer, static_cast<std::size_t>(count > 0 ? count : 0));
    unit->held.clear();
    for (std::string_view rest = input; !rest.empty();)
      send(unit->answer(rest));
    control.hear(unit->heard);
    unit->heard.clear();
    if (mute) unit->streaming = false;
    if (unit->streaming) send(unit->record());
  }
}

inline void serve_script(int fd, const Script& script, const std::atomic<bool>& stop,
                         const std::atomic<bool>& mute) {
  ScriptControl control;
  serve_script(fd, script, stop, mute, control);
}

class ScriptedPort {
public:
  explicit ScriptedPort(const Script& script = {})
      : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
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
    thread_ = std::thread([this, script] { serve_script(master_, script, stop_, mute, control); });
  }
  ~ScriptedPort() { unplug(); }
  ScriptedPort(const ScriptedPort&) = delete;
  ScriptedPort& operator=(const ScriptedPort&) = delete;

  const std::string& path() const { return path_; }
  /// Removes the device. The host's end hangs up.
  void unplug() {
    if (!thread_.joinable()) return;
    stop_ = true;
    thread_.join();
    ::close(slave_);
    ::close(master_);
  }

  std::atomic<bool> mute{false}; // while true, streaming ends as soon as it is asked for
  ScriptControl control;

private:
  int master_ = -1;
  int slave_ = -1;
  std::string path_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

} // namespace nendo::test
