#pragma once
// Watches which gloves, and which ports that may be a glove's, are plugged in and pulled out.

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/devices.hpp>

namespace nendo::driver {

struct DeviceEvent {
  bool attached = true; ///< false: detached
  GloveCandidate candidate;
};

/// Has no thread of its own: next() waits for the system's events. No event is lost between two
/// calls. Asking thread, but for stop().
class NENDO_API DeviceWatcher {
public:
  /// Lists what is there and begins to watch. Error: failed (the system allows no more watches).
  static Result<std::unique_ptr<DeviceWatcher>> open();

  DeviceWatcher() = default;
  DeviceWatcher(const DeviceWatcher&) = delete;
  DeviceWatcher& operator=(const DeviceWatcher&) = delete;
  virtual ~DeviceWatcher() = default;

  /// Returns what was there when it was opened. The list never changes.
  virtual const std::vector<GloveCandidate>& present() const noexcept = 0;
  /// Returns true if the system gives events of USB devices: udev's, or the kernel's where udev
  /// does not run. Otherwise only the nodes in /dev are watched, and a USB glove without a serial
  /// port goes unnoticed. Some containers withhold all events although this returns true.
  virtual bool sees_usb() const noexcept = 0;
  /// Waits for the next event and returns it; returns nullopt after `timeout`, after stop(), and
  /// when a signal arrived. A device is announced when its node and links are made, or 2 s after it
  /// was seen.
  virtual std::optional<DeviceEvent> next(std::chrono::milliseconds timeout) = 0;
  /// Ends a next() that waits, and all later ones. Thread-safe.
  virtual void stop() noexcept = 0;
};

} // namespace nendo::driver
