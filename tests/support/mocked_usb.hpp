#pragma once
// A USB bus under umockdev. Gloves are plugged in and pulled out. Their models answer what the host
// does through /dev/bus/usb, and it is logged. It is not for timing: a mocked node is always ready,
// so that libusb never sleeps.

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "support/usb_gloves.hpp"

struct _UMockdevTestbed; // NOLINT(bugprone-reserved-identifier): umockdev's own

namespace nendo::test {

/// The log of a device. Read it while nobody uses the device, or under `mutex`.
struct UsbLog {
  int detached = 0;             ///< times that the kernel's driver lost the glove's interface
  int attached = 0;             ///< times that it was given back
  bool kernel_has_mouse = true; ///< interface 0 of a device that has two was never touched
  bool kernel_has_glove = true;
  bool claimed = false;
  int max_under_way = 0; ///< interrupt transfers at one time
  int under_way = 0;
  std::vector<UsbBytes> controls; ///< the 8 bytes of every control request
};

class MockedUsb {
public:
  MockedUsb();
  ~MockedUsb(); ///< close what was opened first
  MockedUsb(const MockedUsb&) = delete;
  MockedUsb& operator=(const MockedUsb&) = delete;

  struct Device;
  /// Plugs a glove in at bus 1, `port` ("3") and `address`. With an empty `serial` it has no serial
  /// number.
  Device& plug(UsbGlove& glove, int port, int address, const std::string& serial = {});
  void unplug(Device& device);

  static UsbLog log_of(Device& device);
  /// Lets the next `transfers` transfers fail, as with a bad cable.
  static void spoil(Device& device, int transfers);
  /// Lets the host's next interrupt transfer end without a byte.
  static void send_nothing(Device& device);
  /// Runs `change` while the device's model is at rest.
  template <class Change>
  static void with_model(Device& device, Change&& change) {
    const std::lock_guard lock(mutex_of(device));
    change();
  }
  /// Returns the file behind a device's node, so that its permissions can be changed.
  std::string node_file(const Device& device) const;
  std::string root() const;

private:
  static std::mutex& mutex_of(Device& device);

  _UMockdevTestbed* testbed_;
  std::vector<std::unique_ptr<Device>> devices_;
};

} // namespace nendo::test
