#pragma once
// The serial ports of this machine, as libserialport lists them. Nothing is written to any of them.

#include <string>
#include <vector>

namespace nendo::driver {

struct SerialPortInfo {
  std::string path;        ///< e.g. /dev/ttyUSB0
  std::string description; ///< what the system calls it
  bool is_usb = false;
  std::string manufacturer; ///< the USB strings; empty if there are none
  std::string product;
  int vendor_id = 0; ///< 0 unless is_usb
  int product_id = 0;
};

std::vector<SerialPortInfo> list_serial_ports();

} // namespace nendo::driver
