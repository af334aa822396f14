#pragma once
// Which USB device something is, from what the kernel says in /sys. Nothing is opened.

#include <optional>
#include <string>

#include <nendo/driver/devices.hpp>

namespace nendo::driver {

/// The adapter of a serial port, e.g. /dev/ttyUSB0; nullopt if it has none: a UART, a
/// pseudo-terminal, Bluetooth. Links are not followed.
std::optional<UsbIdentity> usb_identity_of_port(const std::string& port);

/// The device that is plugged in as this number; nullopt if there is none (any more).
std::optional<UsbIdentity> usb_identity_at(unsigned bus, unsigned address);

} // namespace nendo::driver
