#include "transport/serial_ports.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <tuple>

#include "transport/sysfs.hpp"
#include "transport/usb_identity.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;

/// Virtual consoles and pseudo-terminals hang on no device; sockets of the serial driver that no
/// chip sits in have type 0. An rfcomm port is virtual until it is connected.
bool is_a_port(const fs::path& entry, const std::string& name) {
  if (name.starts_with("rfcomm")) return true;
  std::error_code failed;
  return fs::exists(entry / "device", failed) && read_line(entry / "type") != "0";
}

bool by_name_and_number(const std::string& a, const std::string& b) {
  const auto key = [](const std::string& name) {
    const std::size_t end = name.find_last_not_of("0123456789") + 1;
    return std::tuple(name.substr(0, end), name.size(), name);
  };
  return key(a) < key(b);
}

} // namespace

std::vector<SerialPortInfo> list_serial_ports() {
  const fs::path folder = "/sys/class/tty";
  std::vector<std::string> names = names_in(folder);
  std::sort(names.begin(), names.end(), by_name_and_number);
  std::vector<SerialPortInfo> found;
  for (const std::string& name : names) {
    if (!is_a_port(folder / name, name)) continue;
    SerialPortInfo info;
    info.path = "/dev/" + name;
    info.device_number = read_line(folder / name / "dev");
    info.bluetooth = name.starts_with("rfcomm");
    info.usb = usb_identity_of_port(info.path);
    found.push_back(std::move(info));
  }
  return found;
}

} // namespace nendo::driver
