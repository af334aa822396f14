#pragma once
// A pseudo-terminal in raw mode whose far end a thread serves, as a device would.

#include <atomic>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

namespace nendo::test {

class ServedTerminal {
public:
  /// `serve` gets the far end, and returns soon after `stop` has become true.
  using Serve = std::function<void(int master, const std::atomic<bool>& stop)>;

  explicit ServedTerminal(const Serve& serve)
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
    thread_ = std::thread([this, serve] { serve(master_, stop_); });
  }
  ~ServedTerminal() { unplug(); }
  ServedTerminal(const ServedTerminal&) = delete;
  ServedTerminal& operator=(const ServedTerminal&) = delete;

  const std::string& path() const { return path_; }
  /// Removes the device. The host's end hangs up.
  void unplug() {
    if (!thread_.joinable()) return;
    stop_ = true;
    thread_.join();
    ::close(slave_);
    ::close(master_);
  }

private:
  int master_ = -1;
  int slave_ = -1;
  std::string path_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

} // namespace nendo::test
