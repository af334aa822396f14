#pragma once
// What a USB device is called, and how it is known again. Nothing is asked of the device: the
// kernel has read all of it when the device was plugged in, and gives it to everybody.

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <nendo/base/result.hpp>

namespace nendo::driver {

struct UsbId {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  friend constexpr auto operator<=>(UsbId, UsbId) = default;
};

/// As `lsusb` shows it: 0d7f:0100.
std::string to_string(UsbId id);

/// Texts are the device's own, in one printable line; most gloves have no serial number.
struct UsbIdentity {
  UsbId id;
  std::string node; ///< e.g. /dev/bus/usb/001/007; another one whenever it is plugged in
  std::string port; ///< where it is plugged in, as the kernel names it: 1-4.2
  std::string manufacturer;
  std::string product;
  std::string serial;
};

inline constexpr std::size_t most_usb_ports = 7; ///< on the way to a device (USB 2.0, 4.1.1)

/// `ports` lead from the bus's root to the device.
UsbIdentity identify_usb(UsbId id, unsigned bus, unsigned address,
                         std::span<const std::uint8_t> ports);

/// no_permission, with the rule that grants it.
Error usb_permission_error(const UsbIdentity& identity);

} // namespace nendo::driver
