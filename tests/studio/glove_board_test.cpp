// The gloves of the start, as they are plugged in and unplugged.

#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include "studio/glove_board.hpp"
#include "support/eventually.hpp"
#include "support/pty_host.hpp"

namespace glove_board_test {

using namespace nendo;
using namespace nendo::studio;

namespace {

/// What happens at the ports of a machine. Thread-safe.
class Ports {
public:
  void happens(bool attached, driver::DeviceCandidate device) {
    const std::lock_guard lock(mutex_);
    events_.push_back({attached, std::move(device)});
  }
  std::optional<driver::DeviceEvent> next() {
    const std::lock_guard lock(mutex_);
    if (events_.empty()) return std::nullopt;
    auto event = std::move(events_.front());
    events_.pop_front();
    return event;
  }

private:
  std::mutex mutex_;
  std::deque<driver::DeviceEvent> events_;
};

class PortsWatcher final : public driver::DeviceWatcher {
public:
  explicit PortsWatcher(Ports& ports) : ports_(ports) {}
  const std::vector<driver::DeviceCandidate>& present() const noexcept override { return present_; }
  bool sees_usb() const noexcept override { return true; }
  std::optional<driver::DeviceEvent> next(std::chrono::milliseconds) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return ports_.next();
  }
  void stop() noexcept override {}

private:
  Ports& ports_;
  std::vector<driver::DeviceCandidate> present_;
};

driver::DeviceCandidate glove_at(const std::string& device) {
  driver::DeviceCandidate candidate;
  candidate.device = device;
  candidate.spec = "serial:" + device;
  candidate.identified = true;
  candidate.may_open = true;
  return candidate;
}

/// How often this process has the file open.
int times_open(const std::string& file) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code ignored; // the folder itself is closed by then
    if (std::filesystem::read_symlink(entry.path(), ignored) == file) ++count;
  }
  return count;
}

} // namespace

TEST_SUITE("glove_board") {
  TEST_CASE("a glove has a card while it is plugged in, and its port is open no longer") {
    const test::ServedEmulator emulator;
    const std::string device = emulator->tty_path();
    const driver::DeviceCandidate glove = glove_at(device);
    const int before = times_open(device);
    Ports ports;
    GloveBoard board({}, {}, [&ports]() -> Result<std::unique_ptr<driver::DeviceWatcher>> {
      return std::unique_ptr<driver::DeviceWatcher>(std::make_unique<PortsWatcher>(ports));
    });
    const auto streams = [&] {
      board.update();
      return board.cards().size() == 1 &&
             board.cards().front().state == DeviceCard::State::streaming;
    };
    const auto is_closed = [&] {
      board.update();
      return board.cards().empty() && times_open(device) == before;
    };
    for (int time = 0; time < 2; ++time) {
      CAPTURE(time);
      ports.happens(true, glove);
      REQUIRE(test::eventually(streams));
      CHECK(board.has_gloves());
      CHECK(times_open(device) > before);
      ports.happens(false, glove_at("/dev/another"));
      ports.happens(false, glove);
      REQUIRE(test::eventually(is_closed));
      CHECK_FALSE(board.has_gloves());
    }
  }
}

} // namespace glove_board_test
