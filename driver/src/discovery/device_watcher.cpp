#include <nendo/driver/device_watcher.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <nendo/base/units.hpp>

#include "discovery/candidates.hpp"
#include "discovery/usb_bus.hpp"

namespace nendo::driver {
namespace {

using namespace std::chrono_literals;

/// A port's node appears a little after its adapter, and udev's links later still.
constexpr auto longest_settling = 2s;
constexpr auto settling_look = 100ms;

/// Whether one reading of an inotify descriptor tells of a serial port's node.
bool tells_of_ports(std::string_view events) {
  while (events.size() >= sizeof(inotify_event)) {
    inotify_event event{};
    std::memcpy(&event, events.data(), sizeof event);
    events.remove_prefix(sizeof event);
    const std::string_view name = events.substr(0, event.len);
    if ((event.mask & IN_Q_OVERFLOW) != 0) return true;
    for (const std::string_view kind : {"ttyUSB", "ttyACM", "rfcomm"}) {
      if (name.starts_with(kind)) return true;
    }
    events.remove_prefix(name.size());
  }
  return false;
}

/// What makes it this device and no other: a name taken over by another one is another device.
std::string key_of(const GloveCandidate& candidate) {
  std::string key = candidate.device + '|' + std::string(name_of(candidate.kind));
  if (candidate.usb) {
    key += '|' + std::to_string(candidate.usb->bus) + '|' + std::to_string(candidate.usb->address);
  }
  return key;
}

class EventWatcher final : public DeviceWatcher {
public:
  EventWatcher(int nodes, int stop_event) : nodes_(nodes), stop_event_(stop_event) {
    sees_usb_ = usb_.watch();
    // Listed after it began to watch: what arrives between the two is announced, or was there.
    present_ = list_candidates(usb_);
    add_holders(present_);
    for (const GloveCandidate& candidate : present_)
      known_.emplace(key_of(candidate), candidate);
  }
  ~EventWatcher() override {
    ::close(nodes_);
    ::close(stop_event_);
  }

  const std::vector<GloveCandidate>& present() const noexcept override { return present_; }
  bool sees_usb() const noexcept override { return sees_usb_; }
  std::optional<DeviceEvent> next(std::chrono::milliseconds timeout) override;
  void stop() noexcept override {
    stopped_ = true;
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(stop_event_, &one, sizeof one);
  }

private:
  bool wait(HostTime until);
  bool nodes_changed() const;
  void look();

  UsbBus usb_;
  const int nodes_;      ///< inotify, on /dev
  const int stop_event_; ///< readable once stop() was called
  std::atomic<bool> stopped_{false};
  bool sees_usb_ = false;
  std::vector<GloveCandidate> present_;
  std::map<std::string, GloveCandidate> known_; ///< announced, by key
  std::map<std::string, HostTime> arriving_;    ///< not announced yet; since when it was seen
  HostTime look_until_{};                       ///< something changed shortly before
  std::deque<DeviceEvent> events_;
};

std::optional<DeviceEvent> EventWatcher::next(std::chrono::milliseconds timeout) {
  const HostTime deadline = HostClock::now() + timeout;
  while (!stopped_) {
    if (!events_.empty()) {
      DeviceEvent event = std::move(events_.front());
      events_.pop_front();
      return event;
    }
    const HostTime now = HostClock::now();
    if (now >= deadline && timeout > 0ms) return std::nullopt;
    const bool settling = now < look_until_ || !arriving_.empty();
    if (!wait(settling ? std::min(deadline, now + settling_look) : deadline)) return std::nullopt;
    const bool usb_changed = usb_.changed();
    const bool changed = nodes_changed() || usb_changed;
    if (changed) look_until_ = HostClock::now() + longest_settling;
    if (changed || settling) look();
    if (timeout <= 0ms && events_.empty()) return std::nullopt;
  }
  return std::nullopt;
}

/// False if a signal arrived.
bool EventWatcher::wait(HostTime until) {
  std::vector<pollfd> entries = usb_.wait_on();
  entries.push_back({nodes_, POLLIN, 0});
  entries.push_back({stop_event_, POLLIN, 0});
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - HostClock::now());
  const int wait_ms = static_cast<int>(std::clamp<long>(left.count(), 0, 60'000));
  return ::poll(entries.data(), entries.size(), wait_ms) >= 0 || errno != EINTR;
}

bool EventWatcher::nodes_changed() const {
  std::array<char, 4096> buffer{};
  bool changed = false;
  for (ssize_t count = 0; (count = ::read(nodes_, buffer.data(), buffer.size())) > 0;) {
    changed |= tells_of_ports({buffer.data(), static_cast<std::size_t>(count)});
  }
  return changed;
}

/// Announces the differences between what is there and what was.
void EventWatcher::look() {
  std::map<std::string, GloveCandidate> there;
  for (GloveCandidate& candidate : list_candidates(usb_))
    there.emplace(key_of(candidate), std::move(candidate));
  for (auto at = known_.begin(); at != known_.end();) {
    const bool gone = !there.contains(at->first);
    if (gone) events_.push_back({false, std::move(at->second)});
    at = gone ? known_.erase(at) : std::next(at);
  }
  std::erase_if(arriving_, [&](const auto& arrival) { return !there.contains(arrival.first); });
  const HostTime now = HostClock::now();
  for (auto& [key, candidate] : there) {
    if (known_.contains(key)) continue;
    const HostTime since = arriving_.try_emplace(key, now).first->second;
    if (!is_settled(candidate) && now - since < longest_settling) continue;
    arriving_.erase(key);
    known_.emplace(key, candidate);
    events_.push_back({true, std::move(candidate)});
  }
}

} // namespace

Result<std::unique_ptr<DeviceWatcher>> DeviceWatcher::open() {
  const int nodes = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  const int stop_event = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  const auto fail = [&](const std::string& what) {
    const std::string reason = std::strerror(errno);
    ::close(nodes);
    ::close(stop_event);
    return Error{Errc::failed, what + ": " + reason +
                                   "; close programs that watch files, or raise "
                                   "fs.inotify.max_user_instances (sysctl)"};
  };
  if (nodes < 0 || stop_event < 0) return fail("devices cannot be watched");
  if (::inotify_add_watch(nodes, "/dev/", IN_CREATE | IN_DELETE | IN_MOVED_TO | IN_MOVED_FROM) < 0)
    return fail("/dev cannot be watched");
  return std::unique_ptr<DeviceWatcher>(std::make_unique<EventWatcher>(nodes, stop_event));
}

} // namespace nendo::driver
