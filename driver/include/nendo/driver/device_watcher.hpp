#pragma once
// Reports possible gloves and trackers as they are attached and detached.

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/devices.hpp>

namespace nendo::driver {

struct DeviceEvent {
  bool attached = true; ///< false: detached
  DeviceCandidate candidate;
};

/// Has no thread of its own: next() waits for events of the system. No event is lost between two
/// calls. Asking thread, except stop().
class NENDO_API DeviceWatcher {
public:
  /// Lists the devices and begins to watch. Error: failed (the system allows no more watches).
  static Result<std::unique_ptr<DeviceWatcher>> open();

  DeviceWatcher() = default;
  DeviceWatcher(const DeviceWatcher&) = delete;
  DeviceWatcher& operator=(const DeviceWatcher&) = delete;
  virtual ~DeviceWatcher() = default;

  /// Returns the devices that were present at open(). Constant.
  virtual const std::vector<DeviceCandidate>& present() const noexcept = 0;
  /// Returns true if USB events are available, from udev or, without udev, from the kernel.
  /// Otherwise only the nodes in /dev and /dev/input are watched, and a USB glove without a serial
  /// port is not detected. Some containers receive no events although this returns true.
  virtual bool sees_usb() const noexcept = 0;
  /// Waits for the next event and returns it; returns nullopt after `timeout`, after stop(), and on
  /// a signal. An attached device is reported when its node and links exist, or after 2 s.
  virtual std::optional<DeviceEvent> next(std::chrono::milliseconds timeout) = 0;
  /// Ends a waiting next() and all later calls. Thread-safe.
  virtual void stop() noexcept = 0;
};

} // namespace nendo::driver
