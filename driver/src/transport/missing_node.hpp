#pragma once
// A device that the kernel has, but this system has no node for: as in a container, which sees the
// host's /sys and has a /dev of its own.

#include <filesystem>
#include <optional>
#include <string>

namespace nendo::driver {

/// Returns what to do if the kernel has the serial port or USB device `path` (/dev/ttyUSB0,
/// /dev/bus/usb/001/005) and there is no node in its place; otherwise nothing. Which container this
/// is, files below `root` tell. Reads the file system; opens no device.
std::optional<std::string> missing_node(const std::string& path,
                                        const std::filesystem::path& root = "/");

} // namespace nendo::driver
