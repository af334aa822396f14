#pragma once
// The serial ports of this machine, as the kernel lists them. Not libserialport's list: that opens
// the on-board ports, which moves their modem lines, leaves out those that this user may not open,
// and does not know Bluetooth's.

#include <optional>
#include <string>
#include <vector>

#include <nendo/driver/devices.hpp>

namespace nendo::driver {

struct SerialPortInfo {
  std::string path;          ///< e.g. /dev/ttyUSB0
  std::string device_number; ///< "188:0", by which udev's records are found
  bool bluetooth = false;
  std::optional<UsbIdentity> usb; ///< the adapter's, if it is one
};

/// Sorted by name, numbers as numbers. Nothing is opened.
std::vector<SerialPortInfo> list_serial_ports();

} // namespace nendo::driver
