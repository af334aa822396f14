#pragma once
// The identity of a USB device: the numbers of its model, and its own strings.

#include <compare>
#include <cstdint>
#include <string>

#include <nendo/base/api.hpp>

namespace nendo::udev {

/// The numbers of a model. Many adapters with different devices behind them share one pair.
struct UsbId {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  friend constexpr auto operator<=>(UsbId, UsbId) = default;
};

/// Returns the numbers as `lsusb` shows them, e.g. "0d7f:0100".
NENDO_API std::string to_string(UsbId id);

/// A USB device as the kernel describes it. Strings are printable ASCII; other bytes became '?'.
struct UsbIdentity {
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::string manufacturer;
  std::string product;
  std::string serial;
  std::string place;         ///< bus and hub ports, e.g. "1-2.4": where it is plugged in
  unsigned bus = 0;          ///< as in /dev/bus/usb/BUS/ADDRESS
  unsigned address = 0;      ///< changes whenever it is plugged in
  int interface_number = -1; ///< the port's interface, at adapters that have several; -1 if unknown
  int port_number = 0;       ///< the port's number, at interfaces that have several
  friend bool operator==(const UsbIdentity&, const UsbIdentity&) = default;
};

constexpr UsbId id_of(const UsbIdentity& identity) noexcept {
  return {identity.vendor_id, identity.product_id};
}

} // namespace nendo::udev
