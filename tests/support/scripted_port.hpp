#pragma once
// Something at the far end of a pseudo-terminal that behaves as a test wants it to: a CyberGlove's
// interface unit with the few commands that a driver uses, or worse company. Knows nothing of the
// code under test.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

namespace nendo::test {

enum class Manner { good, silent, babbling, modem, no_glove };

struct Script {
  Manner manner = Manner::good;
  unsigned sensors = 22; // 22 or 18
  bool right = true;
  bool knows_options = true; // D and U
  unsigned swap_after = 0;   // records after which it is a glove of 18 sensors; 0: never
  bool long_replies = false; // set replies of three bytes, as the vendor's library expects them
};

/// What a unit sends for a command, and the records it streams. Value k of a record is 10 + k.
class ScriptedUnit {
public:
  explicit ScriptedUnit(const Script& script) : script_(script), sensors_(script.sensors) {}

  std::string answer(std::string_view& input) {
    const char command = take(input);
    if (command == '\x09') return {'\x09', '\0'};
    if (command == '\x03') {
      streaming = false;
      return {'\x03', '\0'};
    }
    if (command == '?') return input.empty() ? hold(command) : query(take(input));
    if (command == 'S') {
      streaming = true;
      return {};
    }
    if (command == 'D' || command == 'U') {
      if (input.empty()) return hold(command);
      const bool on = take(input) != '\0';
      if (!script_.knows_options) return unknown();
      (command == 'D' ? time_stamp_ : status_) = on;
      return script_.long_replies ? std::string{command, '\x01', '\0'} : std::string{command, '\0'};
    }
    return unknown();
  }

  std::string record() {
    if (++records_ == script_.swap_after) sensors_ = 18;
    std::string bytes = "S";
    for (unsigned k = 0; k < sensors_; ++k)
      bytes.push_back(static_cast<char>(10 + k));
    if (time_stamp_) bytes += "\x8A\x02\x01\x01\x01"; // 0x00010002, as the manual sends it
    if (status_) bytes += '\x87';
    bytes.push_back('\0');
    return bytes;
  }

  bool streaming = false;
  std::string held; // a command whose argument has not arrived

private:
  static char take(std::string_view& input) {
    const char c = input.front();
    input.remove_prefix(1);
    return c;
  }
  std::string hold(char command) {
    held = command;
    return {};
  }
  static std::string unknown() { return {'e', '?', '\0'}; }
  static std::string reply(char letter, std::string_view data) {
    std::string bytes{'?', letter};
    bytes += data;
    bytes.push_back('\0');
    return bytes;
  }
  std::string query(char letter) const {
    using namespace std::string_view_literals;
    const bool all = sensors_ == 22;
    switch (letter) {
    case 'G':
      return reply(letter, script_.manner == Manner::no_glove ? "\x01"sv : "\x03"sv);
    case 'S':
      return reply(letter, all ? "\x16"sv : "\x12"sv);
    case 'K':
      return reply(letter, all ? "\x7F\xFF\x7F"sv : "\x3F\xBB\x7B"sv);
    case 'M':
      return reply(letter, "\xFF\xFF\xFF"sv);
    case 'N':
      return reply(letter, "\x18"sv);
    case 'R':
      return reply(letter, script_.right ? "\x01"sv : "\x00"sv);
    case 'T':
      return reply(letter, "\x00\x05\x01\x00"sv); // 1280, 1: 90 Hz
    case 'i':
      return reply(letter, " \r\nScripted\x1B CyberGlove \r\nsecond line\r\n"sv);
    default:
      return unknown();
    }
  }

  const Script script_;
  unsigned sensors_;
  unsigned records_ = 0;
  bool time_stamp_ = false;
  bool status_ = false;
};

/// Serves a ScriptedUnit on any file descriptor until told to stop; a record every 2 ms while it
/// streams.
inline void serve_script(int fd, const Script& script, const std::atomic<bool>& stop,
                         const std::atomic<bool>& mute) {
  ScriptedUnit unit(script);
  const auto send = [fd](std::string_view bytes) {
    // A host that does not read loses bytes, as on a wire.
    [[maybe_unused]] const ssize_t sent = ::write(fd, bytes.data(), bytes.size());
  };
  while (!stop) {
    pollfd entry{fd, POLLIN, 0};
    char buffer[256];
    const bool readable = ::poll(&entry, 1, 2) > 0 && (entry.revents & POLLIN) != 0;
    const ssize_t count = readable ? ::read(fd, buffer, sizeof buffer) : 0;
    if (script.manner == Manner::babbling) send("x7 noise \x01\x02");
    if (script.manner == Manner::modem && count > 0) send("\r\nERROR\r\n");
    if (script.manner != Manner::good && script.manner != Manner::no_glove) continue;
    std::string input =
        unit.held + std::string(buffer, static_cast<std::size_t>(count > 0 ? count : 0));
    unit.held.clear();
    for (std::string_view rest = input; !rest.empty();)
      send(unit.answer(rest));
    if (mute) unit.streaming = false;
    if (unit.streaming) send(unit.record());
  }
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
    thread_ = std::thread([this, script] { serve_script(master_, script, stop_, mute); });
  }
  ~ScriptedPort() { unplug(); }
  ScriptedPort(const ScriptedPort&) = delete;
  ScriptedPort& operator=(const ScriptedPort&) = delete;

  const std::string& path() const { return path_; }
  /// The device is gone; the host's end hangs up.
  void unplug() {
    if (!thread_.joinable()) return;
    stop_ = true;
    thread_.join();
    ::close(slave_);
    ::close(master_);
  }

  std::atomic<bool> mute{false}; // while true, streaming ends as soon as it is asked for

private:
  int master_ = -1;
  int slave_ = -1;
  std::string path_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

} // namespace nendo::test
