#pragma once
// Applies udev itself to emulated devices, to test rules.

#include <filesystem>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "support/program.hpp"
#include "support/shell.hpp"
#include "support/temporary_folder.hpp"

namespace nendo::test {

/// A USB device and, if `port` is not empty, its serial port. An empty text means that it has no
/// such property.
struct PluggedDevice {
  std::string place; ///< "1-2"
  std::string vendor_id, product_id, manufacturer, product, serial;
  std::string port; ///< "ttyUSB0"
  std::string driver = "ftdi_sio";
  std::string interface_number = "00";

  std::string usb_path() const { return "/devices/pci0000:00/0000:00:14.0/usb1/" + place; }
  std::string interface_path() const { return usb_path() + "/" + place + ":1." + interface_number; }
  std::string serial_path() const { return interface_path() + "/" + port; }
  std::string tty_path() const { return serial_path() + "/tty/" + port; }
};

/// Returns a description for umockdev. Ports of one adapter share its USB device.
inline std::string describe(const std::vector<PluggedDevice>& devices) {
  std::ostringstream text;
  std::map<std::string, int> seen;
  int minor = 3;
  for (const PluggedDevice& device : devices) {
    if (seen[device.place]++ == 0) {
      ++minor;
      text << "P: " << device.usb_path() << "\nN: bus/usb/001/00" << minor
           << "\nE: DEVNAME=/dev/bus/usb/001/00" << minor
           << "\nE: DEVTYPE=usb_device\nE: DRIVER=usb\nE: SUBSYSTEM=usb\nE: MAJOR=189\nE: MINOR="
           << minor - 1 << "\nA: busnum=1\\n\nA: devnum=" << minor
           << "\\n\nA: idVendor=" << device.vendor_id << "\\n\nA: idProduct=" << device.product_id
           << "\\n\n";
      if (!device.manufacturer.empty())
        text << "A: manufacturer=" << device.manufacturer << "\\n\n";
      if (!device.product.empty()) text << "A: product=" << device.product << "\\n\n";
      if (!device.serial.empty()) text << "A: serial=" << device.serial << "\\n\n";
      text << "\n";
    }
    if (device.port.empty()) continue;
    const char number = device.port.back();
    text << "P: " << device.interface_path()
         << "\nE: DEVTYPE=usb_interface\nE: DRIVER=" << device.driver
         << "\nE: SUBSYSTEM=usb\nA: bInterfaceNumber=" << device.interface_number
         << "\\n\n\nP: " << device.serial_path() << "\nE: DRIVER=" << device.driver
         << "\nE: SUBSYSTEM=usb-serial\nL: driver=../../../../../../../bus/usb-serial/drivers/"
         << device.driver << "\nA: port_number=0\\n\n"
         << (device.driver == "ftdi_sio" ? "A: latency_timer=16\\n\n" : "")
         << "\nP: " << device.tty_path() << "\nN: " << device.port << "\nE: DEVNAME=/dev/"
         << device.port << "\nE: MAJOR=188\nE: MINOR=" << number
         << "\nE: SUBSYSTEM=tty\nA: dev=188:" << number << "\\n\nL: device=../../../" << device.port
         << "\n\n";
  }
  return text.str();
}

/// An input device of the kernel. Its numbers and capabilities are hexadecimal, as /sys has them.
struct PluggedInput {
  std::string parent; ///< "/devices/virtual/misc/uhid/0005:256F:C63A.0001"
  std::string number; ///< "5" of event5
  std::string vendor, product;
  std::string relative = "0", absolute = "0";

  std::string input_path() const { return parent + "/input/input" + number; }
  std::string event_path() const { return input_path() + "/event" + number; }
};

/// The same for input devices. A mouse and a joystick, mouseN and jsN, are not described.
inline std::string describe(const std::vector<PluggedInput>& inputs) {
  std::ostringstream text;
  for (const PluggedInput& input : inputs) {
    const int minor = 64 + std::stoi(input.number);
    text << "P: " << input.input_path() << "\nE: SUBSYSTEM=input\nA: id/vendor=" << input.vendor
         << "\\n\nA: id/product=" << input.product << "\\n\nA: capabilities/rel=" << input.relative
         << "\\n\nA: capabilities/abs=" << input.absolute << "\\n\n\nP: " << input.event_path()
         << "\nN: input/event" << input.number << "\nE: DEVNAME=/dev/input/event" << input.number
         << "\nE: SUBSYSTEM=input\nE: MAJOR=13\nE: MINOR=" << minor << "\nA: dev=13:" << minor
         << "\\n\nL: device=../../input" << input.number << "\n\n";
  }
  return text.str();
}

/// What udev said of each path, and the links to ports that it made.
struct UdevVerdict {
  std::map<std::string, std::string> said;
  std::string links;

  /// Returns a property of the device; an empty text if it has no such property.
  std::string property(const std::string& path, const std::string& name) const {
    for (const std::string& line : lines_of(said.at(path))) {
      if (line.starts_with(name + "=")) return line.substr(name.size() + 1);
    }
    return {};
  }
  bool mentions(const std::string& path, const std::string& text) const {
    return said.at(path).find(text) != std::string::npos;
  }
  /// Returns whether udev complains about a place in the rules: "60-x.rules:1 Unknown key ...".
  bool complains() const {
    for (const auto& [path, text] : said) {
      for (const std::string& line : lines_of(text)) {
        if (line.find(".rules:") == std::string::npos) continue;
        for (const char* const word : {"nvalid", "nknown", "no matching", "ailed", "ignoring"})
          if (line.find(word) != std::string::npos) return true;
      }
    }
    return false;
  }
};

/// Returns udev's verdict on the devices of a description; nothing if this machine does not let a
/// program have a /dev of its own.
inline std::optional<UdevVerdict> ask_udev_of(const std::string& devices,
                                              const std::filesystem::path& rules,
                                              const std::vector<std::string>& paths) {
  const TemporaryFolder folder;
  const auto description = folder.path() / "devices.umockdev";
  write_file(description, devices);
  std::string command =
      NENDO_UDEV_SANDBOX " '" + rules.string() + "' '" + description.string() + "'";
  for (const std::string& path : paths)
    command += " '" + path + "'";
  const Spoken done = shell(command);
  if (done.exit_code == 77) return std::nullopt;
  UdevVerdict verdict;
  std::string path;
  for (const std::string& line : lines_of(done.out)) {
    if (line.starts_with("== ")) {
      path = line.substr(3);
    } else {
      (path == "links" ? verdict.links : verdict.said[path]) += line + '\n';
    }
  }
  return verdict;
}
inline std::optional<UdevVerdict> ask_udev(const std::filesystem::path& rules,
                                           const std::vector<PluggedDevice>& devices,
                                           const std::vector<std::string>& paths) {
  return ask_udev_of(describe(devices), rules, paths);
}
inline std::optional<UdevVerdict> ask_udev(const std::filesystem::path& rules,
                                           const std::vector<PluggedInput>& inputs,
                                           const std::vector<std::string>& paths) {
  return ask_udev_of(describe(inputs), rules, paths);
}

} // namespace nendo::test
