#pragma once
// The links that udev makes to serial ports; their names stay when the ports' names change. They
// are read from /dev, not asked of libudev: a container may have them without udev's database.

#include <map>
#include <string>

namespace nendo::driver {

/// The links to one port; a text is empty if there is no such link.
struct PortLinks {
  std::string nendo;   ///< /dev/nendo/...: a udev rule says that it is a glove
  std::string by_id;   ///< /dev/serial/by-id/...: by maker, model and serial number
  std::string by_path; ///< /dev/serial/by-path/...: by where it is plugged in
};

/// Returns all links, by port, e.g. "/dev/ttyUSB0".
std::map<std::string, PortLinks> find_port_links();

} // namespace nendo::driver
