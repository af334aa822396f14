#include <nendo/driver/open_glove.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <optional>
#include <system_error>

#include <unistd.h>

#include "discovery/usb_gloves.hpp"
#include "transport/open_transport.hpp"
#include "transport/serial_ports.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;

/// Names that only a glove's maker puts into a device's own description.
constexpr std::array<std::string_view, 3> maker_names{"cyberglove", "virtual technologies",
                                                      "immersion"};

/// Adapters that anything may hang on, so that nothing may be written to them unasked.
struct Adapter {
  int vendor_id;
  int product_id;
  std::string_view name;
};
constexpr std::array adapters{
    Adapter{0x0403, 0x6001, "FTDI"},
    Adapter{0x067B, 0x2303, "Prolific"},
    Adapter{0x10C4, 0xEA60, "Silicon Labs"},
    Adapter{0x1A86, 0x7523, "WCH"},
};

bool names_a_maker(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::any_of(maker_names.begin(), maker_names.end(),
                     [&](std::string_view name) { return text.find(name) != std::string::npos; });
}

/// The link in /dev/nendo that udev rules made to `port`, if any.
std::optional<std::string> udev_link(const std::string& port) {
  std::error_code no_such_folder;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev/nendo", no_such_folder)) {
    if (resolve_port(entry.path().string()) == port) return entry.path().string();
  }
  return std::nullopt;
}

std::string why_maybe(const SerialPortInfo& port) {
  if (port.path.starts_with("/dev/rfcomm")) return "may be a glove: Bluetooth serial port";
  if (!port.is_usb) return "may be a glove: serial port";
  for (const Adapter& adapter : adapters) {
    if (adapter.vendor_id == port.vendor_id && adapter.product_id == port.product_id) {
      return "may be a glove: USB-serial adapter (" + std::string(adapter.name) + ")";
    }
  }
  return "may be a glove: USB serial device";
}

GloveCandidate judge(const SerialPortInfo& port) {
  GloveCandidate candidate;
  candidate.device = port.path;
  candidate.spec = "serial:" + port.path;
  candidate.description = port.description;
  candidate.may_open = ::access(port.path.c_str(), R_OK | W_OK) == 0;
  if (const auto link = udev_link(port.path)) {
    candidate.spec = "serial:" + *link;
    candidate.reason = "a udev rule names it " + *link;
    candidate.identified = true;
  } else if (names_a_maker(port.manufacturer + " " + port.product)) {
    candidate.reason = "calls itself " + port.manufacturer + " " + port.product;
    candidate.identified = true;
  } else {
    candidate.reason = why_maybe(port);
  }
  return candidate;
}

} // namespace

std::vector<GloveCandidate> find_gloves() {
  std::vector<GloveCandidate> found;
  for (const SerialPortInfo& port : list_serial_ports())
    found.push_back(judge(port));
  for (GloveCandidate& glove : find_usb_gloves())
    found.push_back(std::move(glove));
  std::stable_partition(found.begin(), found.end(),
                        [](const GloveCandidate& candidate) { return candidate.identified; });
  return found;
}

} // namespace nendo::driver
