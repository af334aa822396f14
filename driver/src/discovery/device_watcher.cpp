#include <nendo/driver/device_watcher.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <nendo/base/unique_fd.hpp>
#include <nendo/base/units.hpp>

#include "discovery/candidates.hpp"
#include "transport/udev_devices.hpp"

namespace nendo::driver {
namespace {

using namespace std::chrono_literals;

/// A port's node appears a little after its adapter, and udev's links later still. A device that
/// leaves is announced before the kernel has taken its entry out of /sys.
constexpr auto max_settling = 2s;
constexpr auto settling_look = 100ms;

/// Returns what makes it this device and no other: if another device takes over the name, it is a
/// departure and an arrival.
std::string key_of(const DeviceCandidate& candidate) {
  std::string key = candidate.device + '|' + std::string(name_of(candidate.kind));
  if (candidate.kind == DeviceKind::input_device) key += '|' + candidate.description;
  if (candidate.usb) {
    key += '|' + std::to_string(candidate.usb->bus) + '|' + std::to_string(candidate.usb->address);
  }
  return key;
}

/// Returns null if there are no events to be had. udev's come when its rules have run; where it
/// does not run, the kernel's own have to do.
UdevMonitor watch_devices(::udev* context) {
  std::error_code failed;
  const bool udev_runs = std::filesystem::exists("/run/udev/control", failed);
  UdevMonitor monitor(udev_monitor_new_from_netlink(context, udev_runs ? "udev" : "kernel"));
  if (!monitor) return nullptr;
  udev_monitor_filter_add_match_subsystem_devtype(monitor.get(), "usb", "usb_device");
  udev_monitor_filter_add_match_subsystem_devtype(monitor.get(), "tty", nullptr);
  udev_monitor_filter_add_match_subsystem_devtype(monitor.get(), "input", nullptr);
  return udev_monitor_enable_receiving(monitor.get()) >= 0 ? std::move(monitor) : nullptr;
}

bool watch_folder(const UniqueFd& nodes, const char* folder) noexcept {
  return ::inotify_add_watch(nodes.get(), folder,
                             IN_CREATE | IN_DELETE | IN_MOVED_TO | IN_MOVED_FROM) >= 0;
}
/// It is missing while there is no input device, so this is called again and again. A second watch
/// of the same folder changes nothing.
void watch_inputs(const UniqueFd& nodes) noexcept {
  watch_folder(nodes, "/dev/input/");
}

class EventWatcher final : public DeviceWatcher {
public:
  EventWatcher(UniqueFd nodes, UniqueFd stop_event)
      : nodes_(std::move(nodes)), stop_event_(std::move(stop_event)) {
    watch_inputs(nodes_);
    // Listed after it began to watch: what arrives between the two is announced, or was there.
    present_ = list_candidates();
    add_holders(present_);
    for (const DeviceCandidate& candidate : present_)
      known_.emplace(key_of(candidate), candidate);
  }

  const std::vector<DeviceCandidate>& present() const noexcept override { return present_; }
  bool sees_usb() const noexcept override { return monitor_ != nullptr; }
  std::optional<DeviceEvent> next(std::chrono::milliseconds timeout) override {
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
      const Woken woken = wait(settling ? std::min(deadline, now + settling_look) : deadline);
      if (woken == Woken::by_signal) return std::nullopt;
      if (woken == Woken::by_change) look_until_ = HostClock::now() + max_settling;
      if (woken == Woken::by_change || settling) look();
      if (timeout <= 0ms && events_.empty()) return std::nullopt;
    }
    return std::nullopt;
  }

  void stop() noexcept override {
    stopped_ = true;
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(stop_event_.get(), &one, sizeof one);
  }

private:
  enum class Woken : std::uint8_t { by_change, by_time, by_signal };
  Woken wait(HostTime until) {
    const int events = monitor_ ? udev_monitor_get_fd(monitor_.get()) : -1; // poll() leaves -1 out
    std::array<pollfd, 3> entries{
        pollfd{events, POLLIN, 0}, {nodes_.get(), POLLIN, 0}, {stop_event_.get(), POLLIN, 0}};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - HostClock::now());
    const int wait_ms = static_cast<int>(std::clamp<long>(left.count(), 0, 60'000));
    if (::poll(entries.data(), entries.size(), wait_ms) < 0)
      return errno == EINTR ? Woken::by_signal : Woken::by_time;
    if (entries[0].revents == 0 && entries[1].revents == 0) return Woken::by_time;
    // What they say does not matter: look() compares what is there with what was.
    while (monitor_ && UdevDevice(udev_monitor_receive_device(monitor_.get()))) {
    }
    for (std::array<char, 4096> unread{}; ::read(nodes_.get(), unread.data(), unread.size()) > 0;) {
    }
    return Woken::by_change;
  }

  /// Announces the differences between what is there and what was.
  void look() {
    watch_inputs(nodes_);
    std::map<std::string, DeviceCandidate> there;
    for (DeviceCandidate& candidate : list_candidates())
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
      if (!is_settled(candidate) && now - since < max_settling) continue;
      arriving_.erase(key);
      known_.emplace(key, candidate);
      events_.push_back({true, std::move(candidate)});
    }
  }

  const UdevContext context_{udev_new()};
  const UdevMonitor monitor_ = watch_devices(context_.get());
  /// inotify, on /dev and /dev/input: containers may get the nodes alone, without events.
  const UniqueFd nodes_;
  const UniqueFd stop_event_; ///< readable once stop() was called
  std::atomic<bool> stopped_{false};
  std::vector<DeviceCandidate> present_;
  std::map<std::string, DeviceCandidate> known_; ///< announced, by key
  std::map<std::string, HostTime> arriving_;     ///< not announced yet; since when it was seen
  HostTime look_until_{};                        ///< something changed shortly before
  std::deque<DeviceEvent> events_;
};

} // namespace

Result<std::unique_ptr<DeviceWatcher>> DeviceWatcher::open() {
  UniqueFd nodes(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC));
  UniqueFd stop_event(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  const auto fail = [](const std::string& what) {
    return Error{Errc::failed, what + ": " + std::strerror(errno) +
                                   "; close programs that watch files, or raise "
                                   "fs.inotify.max_user_instances (sysctl)"};
  };
  if (!nodes.is_open() || !stop_event.is_open()) return fail("devices cannot be watched");
  if (!watch_folder(nodes, "/dev/")) return fail("/dev cannot be watched");
  return std::unique_ptr<DeviceWatcher>(
      std::make_unique<EventWatcher>(std::move(nodes), std::move(stop_event)));
}

} // namespace nendo::driver
