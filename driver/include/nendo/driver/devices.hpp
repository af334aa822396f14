#pragma once
// Finds devices that may be gloves or trackers, and the reasons why this user cannot use them. No
// device is opened or written to: the data come from libudev, /dev, /sys and /proc.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/udev/usb_identity.hpp>

namespace nendo::driver {

using udev::UsbIdentity;

/// A program that has a device open or locked.
struct DeviceHolder {
  int pid = 0;
  std::string name; ///< the program's name; "another user's program" if it is not visible
};

enum class DeviceKind : std::uint8_t {
  serial_port,
  usb_glove,        ///< a glove that is itself a USB device
  portless_adapter, ///< a USB-serial adapter for which the kernel made no port
  input_device,     ///< a SpaceMouse, a gamepad or a mouse, which can be a tracker
};

constexpr std::string_view name_of(DeviceKind kind) noexcept {
  constexpr std::string_view names[]{"serial_port", "usb_glove", "portless_adapter",
                                     "input_device"};
  return names[static_cast<std::size_t>(kind)];
}

/// A port or device that may be a glove or a tracker.
struct DeviceCandidate {
  DeviceKind kind = DeviceKind::serial_port;
  std::string device; ///< e.g. /dev/ttyUSB0, /dev/bus/usb/001/005 or /dev/input/event5
  /// The udev symlink, which stays the same after a reconnect; empty if there is none.
  std::string stable_name;
  /// The argument for open_glove(), with the stable name if there is one; empty if no driver fits.
  std::string spec;
  /// The argument for open_trackers() of an input device; empty for others, since a serial port
  /// does not show which tracker is behind it.
  std::string tracker_spec;
  std::string description; ///< the device's own description
  std::string reason;      ///< why it may be a glove or a tracker
  /// The device or a udev rule identifies a glove or a tracker; `auto` requires it.
  bool identified = false;
  bool may_open = false; ///< this user has permission
  std::string access;    ///< who may open it: "you", "group dialout", "user anna", "root"; or empty
  bool node_missing = false; ///< the kernel has it but /dev has no node, as in a container
  std::string remedy;        ///< the command or action that makes it usable; empty if may_open
  std::optional<UsbIdentity> usb;
  /// The time by which an FTDI adapter delays short replies: 16 ms by default.
  std::optional<std::chrono::milliseconds> latency_timer;
  bool left_alone = false; ///< a udev rule makes ModemManager ignore it
  std::vector<DeviceHolder> holders;
  bool holders_complete = false; ///< false: some processes could not be inspected
};

/// Returns the serial ports, USB gloves, and the input devices that can be trackers, one entry per
/// device, identified ones first. A device that is removed meanwhile is omitted. Blocks for less
/// than a second.
NENDO_API std::vector<DeviceCandidate> find_devices();

/// Follows symbolic links, e.g. /dev/nendo/right to /dev/ttyUSB0, up to a name that the kernel
/// knows as a serial port. A path that leads nowhere is returned unchanged. Reads the file system;
/// opens nothing.
NENDO_API std::string resolve_port(const std::string& path);

/// Returns the command that sets the latency timer of this port to 1 ms.
NENDO_API std::string latency_timer_remedy(const std::string& port);

/// Returns the running programs that open serial adapters unasked: "ModemManager", "brltty". Reads
/// /proc; blocks briefly.
NENDO_API std::vector<std::string> running_port_grabbers();

} // namespace nendo::driver
