#pragma once
// The links that udev makes to serial ports, which keep their names when ports change theirs.

#include <map>
#include <string>

namespace nendo::driver {

/// What links lead to one port; empty where there is none.
struct PortLinks {
  std::string nendo;   ///< /dev/nendo/...: a udev rule says that it is a glove
  std::string by_id;   ///< /dev/serial/by-id/...: by maker, model and serial number
  std::string by_path; ///< /dev/serial/by-path/...: by where it is plugged in
};

/// By port, e.g. "/dev/ttyUSB0".
std::map<std::string, PortLinks> find_port_links();

} // namespace nendo::driver
