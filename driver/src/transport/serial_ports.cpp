#include "transport/serial_ports.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <tuple>

#include "transport/sysfs.hpp"
#include "transport/udev_devices.hpp"
#include "transport/usb_identity.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// Virtual consoles and pseudo-terminals have no parent; sockets of the serial driver that no chip
/// sits in have type 0. An rfcomm port is virtual until it is connected.
bool is_a_port(udev_device& tty, const std::string& name) {
  return name.starts_with("rfcomm") ||
         (udev_device_get_parent(&tty) != nullptr && attribute_of(tty, "type") != "0");
}

bool by_name_and_number(const SerialPortInfo& a, const SerialPortInfo& b) {
  const auto key = [](const std::string& name) {
    const std::size_t end = name.find_last_not_of("0123456789") + 1;
    return std::tuple(name.substr(0, end), name.size(), name);
  };
  return key(a.path) < key(b.path);
}

/// Only ftdi_sio makes this file.
fs::path timer_file(const std::string& port) {
  return fs::path("/sys/bus/usb-serial/devices") / fs::path(resolve_port(port)).filename() /
         "latency_timer";
}

} // namespace

std::vector<SerialPortInfo> list_serial_ports() {
  std::vector<SerialPortInfo> found;
  for (const UdevDevice& tty : list_udev_devices("tty")) {
    const std::string name = udev_device_get_sysname(tty.get());
    if (!is_a_port(*tty, name)) continue;
    SerialPortInfo info;
    info.path = "/dev/" + name;
    info.bluetooth = name.starts_with("rfcomm");
    info.left_alone = has_flag(*tty, "ID_MM_DEVICE_IGNORE") || has_flag(*tty, "ID_MM_PORT_IGNORE");
    info.usb = usb_identity_of("tty", info.path);
    found.push_back(std::move(info));
  }
  std::sort(found.begin(), found.end(), by_name_and_number);
  return found;
}

std::optional<milliseconds> ftdi_latency_timer(const std::string& port) {
  const auto latency_ms = read_number(timer_file(port));
  return latency_ms ? std::optional(milliseconds(*latency_ms)) : std::nullopt;
}

std::optional<milliseconds> shorten_ftdi_latency(const std::string& port) {
  const auto latency = ftdi_latency_timer(port);
  if (!latency || *latency <= milliseconds(1)) return latency;
  std::ofstream(timer_file(port)) << "1\n";
  return ftdi_latency_timer(port);
}

std::string latency_timer_remedy(const std::string& port) {
  return "echo 1 | sudo tee " + timer_file(port).string();
}

} // namespace nendo::driver
