#pragma once
// The serial ports of this machine, as the kernel lists them. libserialport's list is not used: it
// opens the on-board ports, which moves their modem lines, leaves out those that this user may not
// open, and does not know Bluetooth's.

#include <optional>
#include <string>
#include <vector>

#include <nendo/driver/devices.hpp>

namespace nendo::driver {

struct SerialPortInfo {
  std::string path; ///< e.g. /dev/ttyUSB0
  bool bluetooth = false;
  bool left_alone = false;        ///< udev tells ModemManager to leave it alone
  std::optional<UsbIdentity> usb; ///< the adapter's, if it is one
};

/// Returns the ports, sorted by name, numbers as numbers. Nothing is opened.
std::vector<SerialPortInfo> list_serial_ports();

/// Returns false while udev's rules still run for the port, e.g. /dev/ttyUSB0.
bool udev_is_done_with(const std::string& port);

} // namespace nendo::driver
