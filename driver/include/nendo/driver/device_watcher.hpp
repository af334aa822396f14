#pragma once
// What is plugged in and pulled out, as it happens.

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

/// Has no thread: next() waits for the system's events, and nothing is lost between two calls.
class DeviceWatcher {
public:
  /// Lists what is there and begins to watch. Error: failed (the system gives no more watches).
  static Result<std::unique_ptr<DeviceWatcher>> open();

  DeviceWatcher() = default;
  DeviceWatcher(const DeviceWatcher&) = delete;
  DeviceWatcher& operator=(const DeviceWatcher&) = delete;
  virtual ~DeviceWatcher() = default;

  /// What was there when it was opened. Constant.
  virtual const std::vector<GloveCandidate>& present() const noexcept = 0;
  /// True: USB devices are noticed by libusb's hot-plug. False (containers, machines without USB):
  /// only the nodes of serial ports in /dev are watched, and a USB glove without one goes
  /// unnoticed.
  virtual bool sees_usb() const noexcept = 0;
  /// The next event; nullopt after `timeout`, after stop(), and when a signal arrived. A device is
  /// announced when its node and links are made, or 2 s after it was seen. One thread at a time.
  virtual std::optional<DeviceEvent> next(std::chrono::milliseconds timeout) = 0;
  /// Ends a next() that waits, and all that follow. Any thread.
  virtual void stop() noexcept = 0;
};

} // namespace nendo::driver
