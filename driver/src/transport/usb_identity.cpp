#include "transport/usb_identity.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <utility>

#include <nendo/base/advised_command.hpp>

#include "transport/sysfs.hpp"
#include "transport/udev_devices.hpp"

namespace nendo::driver {
namespace {

constexpr const char* usb_device = "usb_device";

/// nullopt if it has no numbers, which every USB device has.
std::optional<UsbIdentity> identity_of(udev_device& device) {
  const auto vendor_id = number_of(device, "idVendor", 16);
  const auto product_id = number_of(device, "idProduct", 16);
  if (!vendor_id || !product_id || *vendor_id > 0xFFFF || *product_id > 0xFFFF) return std::nullopt;
  UsbIdentity usb;
  usb.vendor_id = static_cast<std::uint16_t>(*vendor_id);
  usb.product_id = static_cast<std::uint16_t>(*product_id);
  usb.manufacturer = attribute_of(device, "manufacturer");
  usb.product = attribute_of(device, "product");
  usb.serial = attribute_of(device, "serial");
  usb.place = printable(udev_device_get_sysname(&device));
  usb.bus = number_of(device, "busnum").value_or(0);
  usb.address = number_of(device, "devnum").value_or(0);
  return usb;
}

/// Reads a number from the nearest parent of a kind; nullopt if there is none.
std::optional<unsigned> number_of_parent(udev_device& child, const char* subsystem,
                                         const char* type, const char* name, int base) {
  udev_device* const parent =
      udev_device_get_parent_with_subsystem_devtype(&child, subsystem, type);
  return parent != nullptr ? number_of(*parent, name, base) : std::nullopt;
}

} // namespace

std::optional<UsbIdentity> usb_identity_of(const char* subsystem, const std::string& node) {
  const std::string name = std::filesystem::path(node).filename().string();
  // A connected rfcomm port is a child of the computer's own Bluetooth dongle.
  if (name.starts_with("rfcomm")) return std::nullopt;
  const UdevDevice child = find_udev_device(subsystem, name);
  udev_device* const parent =
      child ? udev_device_get_parent_with_subsystem_devtype(child.get(), "usb", usb_device)
            : nullptr;
  auto usb = parent != nullptr ? identity_of(*parent) : std::nullopt;
  if (!usb) return std::nullopt;
  const auto interface = number_of_parent(*child, "usb", "usb_interface", "bInterfaceNumber", 16);
  if (interface) usb->interface_number = static_cast<int>(*interface & 0xFFU);
  const auto number = number_of_parent(*child, "usb-serial", nullptr, "port_number", 10);
  usb->port_number = static_cast<int>(number.value_or(0) & 0xFFU);
  return usb;
}

std::vector<UsbIdentity> list_usb_devices() {
  std::vector<UsbIdentity> found;
  for (const UdevDevice& device : list_udev_devices("usb")) {
    const char* const type = udev_device_get_devtype(device.get());
    if (type == nullptr || std::string_view(type) != usb_device) continue; // an interface of one
    if (auto usb = identity_of(*device)) found.push_back(*std::move(usb));
  }
  return found;
}

std::string node_of(const UsbIdentity& identity) {
  std::array<char, 40> node{};
  std::snprintf(node.data(), node.size(), "/dev/bus/usb/%03u/%03u", identity.bus, identity.address);
  return node.data();
}

UsbIdentity identify_usb(UsbId id, unsigned bus, unsigned address,
                         std::span<const std::uint8_t> ports) {
  for (UsbIdentity& known : list_usb_devices()) {
    if (known.bus == bus && known.address == address && id_of(known) == id) return std::move(known);
  }
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
                                   " fixes it for good, sudo chown $USER " + node +
                                   " until it is plugged in again"};
}

} // namespace nendo::driver
