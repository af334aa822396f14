#include "transport/usb_identity.hpp"

#include <array>
#include <cstdio>
#include <fstream>

namespace nendo::driver {
namespace {

std::string kernel_text(const std::string& port, const char* name) {
  constexpr std::size_t most_characters = 126; // of a USB string
  std::ifstream file("/sys/bus/usb/devices/" + port + "/" + name);
  std::string text;
  for (char c = 0; text.size() < most_characters && file.get(c) && c != '\n';) {
    if (c >= 0x20 && c < 0x7F) text.push_back(c);
  }
  return text;
}

} // namespace

std::string to_string(UsbId id) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%04x:%04x", unsigned{id.vendor}, unsigned{id.product});
  return text.data();
}

UsbIdentity identify_usb(UsbId id, unsigned bus, unsigned address,
                         std::span<const std::uint8_t> ports) {
  std::array<char, 32> node{};
  std::snprintf(node.data(), node.size(), "/dev/bus/usb/%03u/%03u", bus, address);
  UsbIdentity identity;
  identity.id = id;
  identity.node = node.data();
  identity.port = std::to_string(bus);
  char separator = '-';
  for (const std::uint8_t port : ports) {
    identity.port += separator + std::to_string(port);
    separator = '.';
  }
  identity.manufacturer = kernel_text(identity.port, "manufacturer");
  identity.product = kernel_text(identity.port, "product");
  identity.serial = kernel_text(identity.port, "serial");
  return identity;
}

Error usb_permission_error(const UsbIdentity& identity) {
  std::array<char, 96> rule{};
  std::snprintf(rule.data(), rule.size(),
                R"(ATTR{idVendor}=="%04x", ATTR{idProduct}=="%04x", TAG+="uaccess")",
                unsigned{identity.id.vendor}, unsigned{identity.id.product});
  return {Errc::no_permission, "USB device " + to_string(identity.id) + " at " + identity.node +
                                   ": no permission to open it; a udev rule with " + rule.data() +
                                   " mends it for good, sudo chown $USER " + identity.node +
                                   " until it is plugged in again"};
}

} // namespace nendo::driver
