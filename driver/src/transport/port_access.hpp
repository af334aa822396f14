#pragma once
// Who may open a device node, and the remedy if this user may not, or if there is no node: a
// container sees the host's /sys, but has a /dev of its own.

#include <filesystem>
#include <optional>
#include <string>

namespace nendo::driver {

struct PortAccess {
  bool granted = false;      ///< this user may read and write it
  std::string who;           ///< "you", "group dialout", "user anna", "root"
  std::string remedy;        ///< empty if granted
  bool node_missing = false; ///< the kernel has the device, and /dev has no node for it
};

/// Reads the file system and does not open the node. `who` is empty if there is no node.
PortAccess port_access(const std::string& path);
/// Returns the same for a device that could not be opened, independent of its mode.
PortAccess refused_access(const std::string& path);

/// Returns the remedy if the kernel has the serial port, USB device or input device `path`
/// (/dev/ttyUSB0, /dev/bus/usb/001/005, /dev/input/event5) and there is no node for it; otherwise
/// nothing. Files below `root` show the kind of container. Opens no device.
std::optional<std::string> missing_node(const std::string& path,
                                        const std::filesystem::path& root = "/");

} // namespace nendo::driver
