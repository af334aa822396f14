#include "discovery/candidates.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include <nendo/driver/open_glove.hpp>
#include <nendo/udev/device_table.hpp>

#include "discovery/programs.hpp"
#include "transport/port_access.hpp"
#include "transport/serial_ports.hpp"
#include "transport/sysfs.hpp"
#include "transport/udev_devices.hpp"
#include "transport/usb_identity.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;

std::string join(std::string_view first, std::string_view second) {
  return std::string(first) + (first.empty() || second.empty() ? "" : " ") + std::string(second);
}

std::string describe(const UsbIdentity& usb) {
  const std::string name = join(usb.manufacturer, usb.product);
  return join(name.empty() ? "USB device without a name" : name,
              usb.serial.empty() ? "" : "(serial number " + usb.serial + ")");
}

void check_access(DeviceCandidate& candidate) {
  set_access(candidate, port_access(candidate.device));
}

/// A serial number that two adapters share names neither: udev's link goes to the one that came
/// last.
bool has_own_serial(const UsbIdentity& usb, const std::vector<SerialPortInfo>& ports) {
  return !usb.serial.empty() &&
         std::none_of(ports.begin(), ports.end(), [&](const SerialPortInfo& other) {
           return other.usb && other.usb->serial == usb.serial && other.usb->place != usb.place;
         });
}

/// `serial:` with the name, or nothing if the grammar cannot express it.
std::string serial_spec(const std::string& name) {
  const auto spec = parse_device_spec("serial:" + name);
  return spec && spec->target == name ? spec->text : std::string{};
}

/// Why a port may be a glove's, where nothing names it one.
std::string why_maybe(const SerialPortInfo& port) {
  if (port.bluetooth) return "may be a glove: Bluetooth serial port";
  if (!port.usb) return "may be a glove: serial port";
  const udev::UsbAdapter* const adapter = udev::find_usb_adapter(id_of(*port.usb));
  return adapter != nullptr
             ? "may be a glove: USB-serial adapter (" + std::string(adapter->maker) + ")"
             : "may be a glove: USB serial device";
}

// The links that udev makes to serial ports; their names stay when the ports' names change. They
// are read from /dev, and not by libudev: a container may have them without udev's database.

/// The links to one port; a string is empty if there is no such link.
struct PortLinks {
  std::string nendo;   ///< /dev/nendo/...: a udev rule says that it is a glove or a tracker
  std::string by_id;   ///< /dev/serial/by-id/...: by maker, model and serial number
  std::string by_path; ///< /dev/serial/by-path/...: by its USB port
};

/// The link to the port of an adapter that `nendo udev bind` has bound to a tracker.
constexpr std::string_view tracker_link = "/dev/nendo/tracker";

/// Returns all links, by port, e.g. "/dev/ttyUSB0".
std::map<std::string, PortLinks> find_port_links() {
  std::map<std::string, PortLinks> links;
  for (const auto& [folder, member] : {std::pair{"/dev/nendo/", &PortLinks::nendo},
                                       {"/dev/serial/by-id/", &PortLinks::by_id},
                                       {"/dev/serial/by-path/", &PortLinks::by_path}}) {
    std::vector<std::string> names = names_in(folder);
    std::sort(names.begin(), names.end()); // so that it is always the same one of several
    for (const std::string& name : names) {
      std::string& link = links[resolve_port(folder + name)].*member;
      if (link.empty()) link = folder + name;
    }
  }
  return links;
}

DeviceCandidate candidate_of_port(const SerialPortInfo& port, const PortLinks& links,
                                  bool own_serial) {
  DeviceCandidate candidate;
  candidate.device = port.path;
  candidate.usb = port.usb;
  candidate.description = port.usb         ? describe(*port.usb)
                          : port.bluetooth ? "Bluetooth serial port"
                                           : "serial port of the computer";
  candidate.stable_name = !links.nendo.empty()                 ? links.nendo
                          : own_serial && !links.by_id.empty() ? links.by_id
                                                               : links.by_path;
  candidate.spec = serial_spec(candidate.stable_name);
  if (candidate.stable_name.empty() || candidate.spec.empty()) {
    candidate.stable_name.clear();
    candidate.spec = serial_spec(port.path);
  }
  if (links.nendo == tracker_link) {
    candidate.reason = "a udev rule says that a tracker is there, not a glove";
    candidate.identified = true;
    candidate.spec.clear();
  } else if (!links.nendo.empty()) {
    candidate.reason = "a udev rule names it " + links.nendo;
    candidate.identified = true;
  } else if (port.usb && udev::names_a_glove(join(port.usb->manufacturer, port.usb->product))) {
    candidate.reason = "calls itself " + join(port.usb->manufacturer, port.usb->product);
    candidate.identified = true;
  } else {
    candidate.reason = why_maybe(port);
  }
  candidate.latency_timer = ftdi_latency_timer(port.path);
  candidate.left_alone = port.left_alone;
  check_access(candidate);
  return candidate;
}

DeviceCandidate start_usb(const UsbIdentity& device, DeviceKind kind) {
  DeviceCandidate candidate;
  candidate.kind = kind;
  candidate.device = node_of(device);
  candidate.usb = device;
  check_access(candidate);
  return candidate;
}

DeviceCandidate candidate_of_usb_glove(const UsbIdentity& device, std::string_view name) {
  DeviceCandidate candidate = start_usb(device, DeviceKind::usb_glove);
  candidate.description = name;
  candidate.reason = "its USB number is that of a glove";
  candidate.identified = true;
  candidate.spec = "usb:" + to_string(id_of(device));
  return candidate;
}

DeviceCandidate candidate_of_portless(const UsbIdentity& device, const udev::UsbAdapter& adapter) {
  DeviceCandidate candidate = start_usb(device, DeviceKind::portless_adapter);
  candidate.description = describe(*candidate.usb);
  candidate.reason = "a USB-serial adapter (" + std::string(adapter.maker) +
                     ") without a serial port: its kernel driver is missing, or brltty took it";
  candidate.remedy = "sudo modprobe " + std::string(adapter.module) + ", then plug it in again";
  return candidate;
}

} // namespace

void set_access(DeviceCandidate& candidate, PortAccess access) {
  candidate.may_open = access.granted;
  candidate.access = std::move(access.who);
  candidate.node_missing = access.node_missing;
  candidate.remedy = std::move(access.remedy);
}

std::vector<DeviceCandidate> list_candidates() {
  std::vector<DeviceCandidate> found;
  const std::vector<SerialPortInfo> ports = list_serial_ports();
  const auto links = find_port_links();
  std::set<std::pair<unsigned, unsigned>> with_port;
  for (const SerialPortInfo& port : ports) {
    const auto own_links = links.find(port.path);
    found.push_back(candidate_of_port(port,
                                      own_links != links.end() ? own_links->second : PortLinks{},
                                      port.usb && has_own_serial(*port.usb, ports)));
    if (port.usb) with_port.emplace(port.usb->bus, port.usb->address);
  }
  for (const UsbIdentity& device : list_usb_devices()) {
    if (with_port.contains({device.bus, device.address})) continue;
    const std::string_view glove = udev::usb_glove_name(id_of(device));
    if (!glove.empty()) {
      found.push_back(candidate_of_usb_glove(device, glove));
    } else if (const auto* adapter = udev::find_usb_adapter(id_of(device))) {
      found.push_back(candidate_of_portless(device, *adapter));
    }
  }
  for (DeviceCandidate& input : list_input_candidates())
    found.push_back(std::move(input));
  std::stable_partition(found.begin(), found.end(),
                        [](const DeviceCandidate& candidate) { return candidate.identified; });
  return found;
}

void add_holders(std::vector<DeviceCandidate>& candidates) {
  std::set<std::string> devices;
  for (const DeviceCandidate& candidate : candidates)
    devices.insert(candidate.device);
  Holders holders = find_holders(devices);
  for (DeviceCandidate& candidate : candidates) {
    candidate.holders = std::move(holders.of[candidate.device]);
    candidate.holders_complete = holders.complete;
  }
}

bool is_settled(const DeviceCandidate& candidate) {
  std::error_code failed;
  if (candidate.kind == DeviceKind::portless_adapter) return false; // its port may yet come
  if (!fs::exists(candidate.device, failed)) return false;
  if (candidate.kind == DeviceKind::usb_glove) return true;
  return udev_is_done_with(candidate.kind == DeviceKind::input_device ? "input" : "tty",
                           candidate.device);
}

std::vector<DeviceCandidate> find_devices() {
  std::vector<DeviceCandidate> found = list_candidates();
  add_holders(found);
  return found;
}

} // namespace nendo::driver
