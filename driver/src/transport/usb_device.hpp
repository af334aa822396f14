#pragma once
// Tells what a USB device is called while it is plugged in. The device itself is not asked: the
// kernel read all of it when the device was plugged in, and every user may read it there.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/devices.hpp>
#include <nendo/udev/usb_identity.hpp>

namespace nendo::driver {

using udev::id_of;
using udev::to_string;
using udev::UsbId;

/// Returns the device's node, e.g. /dev/bus/usb/001/007.
std::string node_of(const UsbIdentity& identity);

inline constexpr std::size_t max_usb_ports = 7; ///< on the way to a device (USB 2.0, 4.1.1)

/// Returns what the kernel says of a device. `ports` lead from the bus's root to the device.
/// Strings stay empty where the kernel says nothing, as in a container without /sys.
UsbIdentity identify_usb(UsbId id, unsigned bus, unsigned address,
                         std::span<const std::uint8_t> ports);

/// Returns the error no_permission, with the rule that grants the permission.
Error usb_permission_error(const UsbIdentity& identity);

} // namespace nendo::driver
