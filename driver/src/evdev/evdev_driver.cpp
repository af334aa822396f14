#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>

#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>

#include "drivers.hpp"
#include "evdev/evdev_motion.hpp"
#include "evdev/evdev_parser.hpp"
#include "evdev/input_device.hpp"
#include "stream/listen.hpp"
#include "stream/stream_tracker.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver::evdev {
namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t only_station = 1;
constexpr HostClock::duration moving_period = 8'333'333ns;
constexpr HostClock::duration resting_period = 25ms; ///< far below the time after which it is lost

Error permission_error(const InputDevice& device) {
  const PortAccess access = refused_input(device);
  return {Errc::no_permission, device.node + " (" + device.name + "): only " + access.who +
                                   " may open it; " + access.remedy};
}

/// The input device that a specification names, and its open node. The transport that open()
/// returned owns the descriptor, so the functions after it need that transport alive.
class InputNode {
public:
  explicit InputNode(std::string name) : name_(std::move(name)) {}

  /// Finds the device again if it was plugged in under another name. Errors: no_device,
  /// no_permission, usage.
  Result<std::unique_ptr<Transport>> open() {
    auto found = find_input_device(name_);
    if (!found) return found.error();
    if (device_ && found->name != device_->name)
      return Error{Errc::no_device, name_ + ": " + device_->name + " is not plugged in; " +
                                        found->name + ", which has its name now, is not used"};
    const int fd = ::open(found->node.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0 && (errno == EACCES || errno == EPERM)) return permission_error(*found);
    if (fd < 0) return open_error(found->node, errno);
    fd_ = fd;
    device_ = *std::move(found);
    return transport_of(fd);
  }

  const InputDevice& device() const noexcept { return *device_; }
  /// Keeps the device's events from all other programs, or no longer. Returns false if another
  /// program does so.
  bool grab(bool wanted) const noexcept {
    // Only a program that grabbed it makes the kernel answer EBUSY.
    return ::ioctl(fd_, EVIOCGRAB, wanted ? 1 : 0) == 0 || errno != EBUSY;
  }
  std::optional<input_absinfo> axis(std::size_t code) const noexcept {
    input_absinfo info{};
    if (::ioctl(fd_, EVIOCGABS(code), &info) < 0) return std::nullopt;
    return info;
  }

private:
  const std::string name_;
  std::optional<InputDevice> device_; ///< after the first opening
  int fd_ = -1;
};

class EvdevProtocol final : public TrackerProtocol {
public:
  EvdevProtocol(std::shared_ptr<InputNode> node, const MotionScale& scale) noexcept
      : node_(std::move(node)), scale_(scale), motion_(scale) {}

  Result<TrackerInfo> identify(Transport& /*transport*/, const std::string& source,
                               IdentifyReason /*reason*/, const ReplyDeadline& /*limit*/) override {
    if (!node_->grab(true)) return in_use(source);
    node_->grab(false);
    const InputDevice& device = node_->device();
    motion_.set_device(device.kind, device.first_button);
    for (std::size_t axis = 0; has_absolute_axes() && axis < axes; ++axis)
      if (const auto info = node_->axis(axis))
        motion_.set_range(axis, {info->minimum, info->maximum, info->flat});
    TrackerInfo info;
    info.model = device.name + ", " + std::string(name_of(device.kind));
    info.stations = {only_station};
    info.is_filtered = true; // a pose that is computed has no noise
    info.facts = {{"node", device.node},
                  {"usb_id", device.vendor_id + ":" + device.product_id},
                  {"speed_m_s", decimal_text(scale_.speed_m_s)},
                  {"turn_rad_s", decimal_text(scale_.turn_rad_s)}};
    return info;
  }

  Result<void> start_stream(Transport& transport, const std::string& source,
                            const ReplyDeadline& /*limit*/) override {
    if (!node_->grab(true)) return in_use(source);
    parser_.count_discarded(drop_waiting(transport));
    parser_.reset();
    read_values();
    count();
    return {};
  }

  void end_stream(Transport& /*transport*/, const ReplyDeadline& /*limit*/) noexcept override {
    node_->grab(false);
  }

  void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept override {
    parser_.push(chunk, [&](const Event& event) {
      motion_.take(event, arrival);
      if (motion_.needs_values()) read_values();
    });
    motion_.advance(arrival);
    if (arrival >= due()) deliver(arrival, sink);
    count();
  }

  std::chrono::milliseconds max_wait() const noexcept override {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(due() - HostClock::now());
    return std::clamp<std::chrono::milliseconds>(left, 1ms, resting_period_ms);
  }

  const StreamCounters& counters() const noexcept override { return counters_; }

private:
  static constexpr auto resting_period_ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(resting_period);

  static Error in_use(const std::string& source) {
    return {Errc::no_device, source + " is in use by another program, which keeps its movements to "
                                      "itself; end that one, e.g. sudo systemctl stop spacenavd"};
  }
  bool has_absolute_axes() const noexcept {
    const InputKind kind = node_->device().kind;
    return kind == InputKind::six_absolute || kind == InputKind::gamepad;
  }
  /// The kernel sends changes only.
  void read_values() noexcept {
    for (std::size_t axis = 0; axis < axes; ++axis) {
      const auto info = has_absolute_axes() ? node_->axis(axis) : std::nullopt;
      motion_.set_value(axis, info ? info->value : motion_.resting_value(axis));
    }
  }

  HostTime due() const noexcept {
    return last_pose_ + (motion_.is_moving() ? moving_period : resting_period);
  }
  void deliver(HostTime arrival, Sink& sink) noexcept {
    // Keeps the rate where reads return late.
    const HostTime was_due = due();
    last_pose_ = arrival - was_due < moving_period ? was_due : arrival;
    PoseSample sample;
    sample.station = only_station;
    sample.position_m = motion_.pose().position_m;
    sample.turn_xyzw = motion_.pose().turn_xyzw;
    ++poses_;
    sink.deliver(sample);
  }
  /// A record, for whom the counts are shown, is a pose; an event is none.
  void count() noexcept {
    counters_ = parser_.counters();
    counters_.records = poses_;
  }

  const std::shared_ptr<InputNode> node_;
  const MotionScale scale_;
  Parser parser_;
  EvdevMotion motion_;
  StreamCounters counters_;
  std::uint64_t poses_ = 0;
  HostTime last_pose_{};
};

Result<double> rate_option(const DeviceSpec& spec, const std::string& key, double usual,
                           double max) {
  const auto option = spec.options.find(key);
  if (option == spec.options.end()) return usual;
  const auto value = number_in<double>(option->second);
  if (value && *value > 0.0 && *value <= max) return *value;
  return Error{Errc::usage, spec.text + ": option " + key + " must be a number above 0, at most " +
                                decimal_text(max)};
}

} // namespace

Result<std::unique_ptr<Tracker>> open_evdev(const DeviceSpec& spec,
                                            std::span<const std::uint16_t> /*stations*/) {
  if (const auto known = allow_options(spec, {"speed", "turn"}); !known) return known.error();
  MotionScale scale;
  const auto speed = rate_option(spec, "speed", scale.speed_m_s, 2.0);
  if (!speed) return speed.error();
  const auto turn = rate_option(spec, "turn", scale.turn_rad_s, 6.0);
  if (!turn) return turn.error();
  scale = {*speed, *turn};
  if (const auto found = find_input_device(spec.target); !found)
    return Error{found.error().code, spec.text + ": " + found.error().message};
  const auto node = std::make_shared<InputNode>(spec.target);
  return open_stream_tracker(
      spec.text, [node] { return node->open(); }, std::make_unique<EvdevProtocol>(node, scale),
      HostClock::now() + open_budget);
}

} // namespace nendo::driver::evdev
