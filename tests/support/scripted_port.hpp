#pragma once
// A ScriptedUnit, or a stranger device, at the far end of a pseudo-terminal.

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include <doctest/doctest.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "support/scripted_unit.hpp"
#include "support/served_terminal.hpp"
#include "transport/transport.hpp"

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
      : terminal_([this, script](int master, const std::atomic<bool>& stop) {
          serve_script(master, script, stop, mute, control);
        }) {}

  const std::string& path() const { return terminal_.path(); }
  void unplug() { terminal_.unplug(); } ///< the host's end hangs up

  std::atomic<bool> mute{false}; // while true, streaming ends as soon as it is asked for
  ScriptControl control;

private:
  ServedTerminal terminal_; // the last member, so that its thread ends first
};

/// Asks the ScriptedUnit at the far end how many sensors its glove has.
inline void check_that_it_answers(driver::Transport& transport) {
  using namespace std::chrono_literals;
  constexpr std::array question{std::byte{'?'}, std::byte{'S'}};
  CHECK(transport.write_all(question, 1s) == driver::IoStatus::done);
  std::string received;
  std::array<std::byte, 16> buffer{};
  while (received.size() < 4) {
    const auto [status, count] = transport.read_some(buffer, 1s);
    REQUIRE(status == driver::IoStatus::done);
    for (std::size_t k = 0; k < count; ++k)
      received.push_back(std::to_integer<char>(buffer[k]));
  }
  CHECK(received == std::string("?S\x16\0", 4));
}

} // namespace nendo::test
