#pragma once
// What a USB device is called while it is plugged in. Nothing is asked of the device: the kernel
// has read all of it when the device was plugged in, and gives it to everybody.

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

/// e.g. /dev/bus/usb/001/007.
std::string node_of(const UsbIdentity& identity);

inline constexpr std::size_t most_usb_ports = 7; ///< on the way to a device (USB 2.0, 4.1.1)

/// `ports` lead from the bus's root to the device. Where the kernel says nothing of it (a container
/// without /sys), texts stay empty.
UsbIdentity identify_usb(UsbId id, unsigned bus, unsigned address,
                         std::span<const std::uint8_t> ports);

/// no_permission, with the rule that grants it.
Error usb_permission_error(const UsbIdentity& identity);

} // namespace nendo::driver
