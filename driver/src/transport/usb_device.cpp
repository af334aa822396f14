#include "transport/usb_device.hpp"

#include <array>
#include <cstdio>

#include <nendo/base/advised_command.hpp>

#include "transport/usb_identity.hpp"

namespace nendo::driver {

std::string node_of(const UsbIdentity& identity) {
  std::array<char, 40> node{};
  std::snprintf(node.data(), node.size(), "/dev/bus/usb/%03u/%03u", identity.bus, identity.address);
  return node.data();
}

UsbIdentity identify_usb(UsbId id, unsigned bus, unsigned address,
                         std::span<const std::uint8_t> ports) {
  if (auto known = usb_identity_at(bus, address); known && id_of(*known) == id) return *known;
  UsbIdentity identity;
  identity.vendor_id = id.vendor;
  identity.product_id = id.product;
  identity.bus = bus;
  identity.address = address;
  identity.place = std::to_string(bus);
  char separator = '-';
  for (const std::uint8_t port : ports) {
    identity.place += separator + std::to_string(port);
    separator = '.';
  }
  return identity;
}

Error usb_permission_error(const UsbIdentity& identity) {
  const std::string node = node_of(identity);
  return {Errc::no_permission, "USB device " + to_string(id_of(identity)) + " at " + node +
                                   ": no permission to open it; " + as_root("udev install") +
                                   " mends it for good, sudo chown $USER " + node +
                                   " until it is plugged in again"};
}

} // namespace nendo::driver
