#pragma once
// USB devices, from the data that the kernel read when they were plugged in, and that every user
// may read. Nothing is opened.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/devices.hpp>
#include <nendo/udev/usb_identity.hpp>

namespace nendo::driver {

using udev::id_of;
using udev::to_string;
using udev::UsbId;

/// Returns the USB device that has this node: the adapter of a serial port ("tty", /dev/ttyUSB0),
/// or an input device ("input", /dev/input/event5). Returns nullopt if there is none: a UART, a
/// pseudo-terminal, Bluetooth. Links are not followed.
std::optional<UsbIdentity> usb_identity_of(const char* subsystem, const std::string& node);

/// Returns all USB devices; none on a machine without USB.
std::vector<UsbIdentity> list_usb_devices();

/// Returns the device's node, e.g. /dev/bus/usb/001/007.
std::string node_of(const UsbIdentity& identity);

inline constexpr std::size_t max_usb_ports =
    7; ///< between the bus's root and a device (USB 2.0, 4.1.1)

/// Returns the kernel's data about a device. `ports` lead from the bus's root to the device.
/// Strings are empty if the kernel has none, as in a container without /sys.
UsbIdentity identify_usb(UsbId id, unsigned bus, unsigned address,
                         std::span<const std::uint8_t> ports);

/// Returns the error no_permission, with the rule that grants the permission.
Error usb_permission_error(const UsbIdentity& identity);

} // namespace nendo::driver
