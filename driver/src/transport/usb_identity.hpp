#pragma once
// Lists USB devices from what the kernel says of them. Nothing is opened.

#include <optional>
#include <string>
#include <vector>

#include <nendo/driver/devices.hpp>

namespace nendo::driver {

/// Returns the adapter of a serial port, e.g. /dev/ttyUSB0; nullopt if it has none: a UART, a
/// pseudo-terminal, Bluetooth. Links are not followed.
std::optional<UsbIdentity> usb_identity_of_port(const std::string& port);

/// Returns the device that is plugged in as this number; nullopt if there is none (any more).
std::optional<UsbIdentity> usb_identity_at(unsigned bus, unsigned address);

/// Returns all USB devices; none on a machine without USB.
std::vector<UsbIdentity> list_usb_devices();

} // namespace nendo::driver
