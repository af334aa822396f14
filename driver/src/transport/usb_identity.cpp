#include "transport/usb_identity.hpp"

#include <filesystem>
#include <system_error>

#include "transport/sysfs.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;

/// nullopt if the folder is not that of a USB device.
std::optional<UsbIdentity> read_identity(const fs::path& folder) {
  const auto vendor_id = read_number(folder / "idVendor", 16);
  const auto product_id = read_number(folder / "idProduct", 16);
  if (!vendor_id || !product_id || *vendor_id > 0xFFFF || *product_id > 0xFFFF) return std::nullopt;
  UsbIdentity usb;
  usb.vendor_id = static_cast<std::uint16_t>(*vendor_id);
  usb.product_id = static_cast<std::uint16_t>(*product_id);
  usb.manufacturer = read_line(folder / "manufacturer");
  usb.product = read_line(folder / "product");
  usb.serial = read_line(folder / "serial");
  usb.place = printable(folder.filename().string());
  usb.bus = read_number(folder / "busnum").value_or(0);
  usb.address = read_number(folder / "devnum").value_or(0);
  return usb;
}

} // namespace

std::optional<UsbIdentity> usb_identity_of_port(const std::string& port) {
  const std::string name = fs::path(port).filename().string();
  // A connected rfcomm port hangs below the computer's own Bluetooth dongle.
  if (name.starts_with("rfcomm")) return std::nullopt;
  auto folder = link_target(fs::path("/sys/class/tty") / name);
  if (!folder) return std::nullopt;
  std::optional<unsigned> interface_number;
  std::optional<unsigned> port_number;
  // The path is the chain of the devices that the port hangs on.
  for (; folder->has_relative_path(); folder = folder->parent_path()) {
    if (!interface_number) interface_number = read_number(*folder / "bInterfaceNumber", 16);
    if (!port_number) port_number = read_number(*folder / "port_number");
    if (auto usb = read_identity(*folder)) {
      if (interface_number) usb->interface_number = static_cast<int>(*interface_number & 0xFFU);
      usb->port_number = static_cast<int>(port_number.value_or(0) & 0xFFU);
      return usb;
    }
  }
  return std::nullopt;
}

std::optional<UsbIdentity> usb_identity_at(unsigned bus, unsigned address) {
  const fs::path devices = "/sys/bus/usb/devices";
  for (const std::string& name : names_in(devices)) {
    if (read_number(devices / name / "devnum") != address) continue;
    if (read_number(devices / name / "busnum") != bus) continue;
    return read_identity(devices / name);
  }
  return std::nullopt;
}

} // namespace nendo::driver
