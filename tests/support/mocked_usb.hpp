#pragma once
// A USB bus under umockdev: gloves are plugged in and pulled out, and what the host does to them
// through /dev/bus/usb is played by their models and noted. Not for timing: a mocked node is always
// ready, so that libusb never sleeps.

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "support/usb_gloves.hpp"

struct _UMockdevTestbed; // NOLINT(bugprone-reserved-identifier): umockdev's own

namespace nendo::test {

/// What became of a device; read it while nobody uses the device, or under `mutex`.
struct UsbLog {
  int detached = 0;             ///< times that the kernel's driver lost the glove's interface
  int attached = 0;             ///< times that it was given back
  bool kernel_has_mouse = true; ///< interface 0 of a device that has two was never touched
  bool kernel_has_glove = true;
  bool claimed = false;
  int most_under_way = 0; ///< interrupt transfers at one time
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
  /// At bus 1, `port` ("3") and `address`. An empty serial number: it has none.
  Device& plug(UsbGlove& glove, int port, int address, const std::string& serial = {});
  void unplug(Device& device);

  static UsbLog log_of(Device& device);
  /// Every transfer from now on fails as by a bad cable, this many times.
  static void spoil(Device& device, int transfers);
  /// The host's next interrupt transfer ends without a byte.
  static void send_nothing(Device& device);
  /// Runs `change` while the device's model is at rest.
  template <class Change>
  static void with_model(Device& device, Change&& change) {
    const std::lock_guard lock(mutex_of(device));
    change();
  }
  /// The file behind a device's node, for its permissions.
  std::string node_file(const Device& device) const;
  std::string root() const;

private:
  static std::mutex& mutex_of(Device& device);

  _UMockdevTestbed* testbed_;
  std::vector<std::unique_ptr<Device>> devices_;
};

} // namespace nendo::test
