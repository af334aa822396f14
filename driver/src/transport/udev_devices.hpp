#pragma once
// Devices as libudev knows them: from the kernel's lists in /sys and from udev's database. Where
// udev does not run, as in containers, devices have no properties, but are listed all the same.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <libudev.h>

namespace nendo::driver {

struct UdevRelease {
  void operator()(::udev* context) const noexcept { udev_unref(context); }
  void operator()(udev_device* device) const noexcept { udev_device_unref(device); }
  void operator()(udev_monitor* monitor) const noexcept { udev_monitor_unref(monitor); }
};
using UdevContext = std::unique_ptr<::udev, UdevRelease>;
using UdevDevice = std::unique_ptr<udev_device, UdevRelease>;
using UdevMonitor = std::unique_ptr<udev_monitor, UdevRelease>;

/// Returns all devices of a subsystem, e.g. "tty". They must not outlive the calling thread, nor be
/// given to another one.
std::vector<UdevDevice> list_udev_devices(const char* subsystem);
/// Returns the device with this name, e.g. "ttyUSB0", under the same conditions; null if there is
/// none.
UdevDevice find_udev_device(const char* subsystem, const std::string& name);

/// Returns false while udev's rules still run for the device with this node, e.g. /dev/ttyUSB0.
bool udev_is_done_with(const char* subsystem, const std::string& node);

/// Returns the first line of an attribute, printable; an empty text if the device has no such
/// attribute.
std::string attribute_of(udev_device& device, const char* name);
/// Returns the attribute as a number; nullopt if it is none.
std::optional<unsigned> number_of(udev_device& device, const char* name, int base = 10);
/// Returns true if a udev rule gave the property the value 1.
bool has_flag(udev_device& device, const char* property);

} // namespace nendo::driver
