#include <nendo/udev/bindings.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>

namespace nendo::udev {
namespace {

constexpr std::string_view head =
    "# Gloves that `nendo udev bind` bound, one a line; lines of your own stay as they are.\n"
    "SUBSYSTEM==\"tty|usb-serial\", ATTRS{bInterfaceNumber}==\"?*\", "
    "ENV{.NENDO_INTERFACE}=\"$attr{bInterfaceNumber}\"\n";
/// What follows the adapter in a binding's rule begins with this.
constexpr std::string_view mark = ", ENV{ID_NENDO_";

/// Returns false for text that could mean something to udev: quotes end it, *?[]| are patterns and
/// $% are substitutions.
bool is_plain(std::string_view text) {
  constexpr std::string_view harmless = " _-.:/+=#,@()";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](unsigned char c) {
    return (std::isalnum(c) != 0 && c < 0x80) ||
           harmless.find(static_cast<char>(c)) != std::string_view::npos;
  });
}

/// Returns what a binding's rule says of the device.
std::string device_part(BoundDevice device) {
  const std::string begin(mark);
  if (device == BoundDevice::tracker) return begin + "TRACKER}=\"1\"";
  return begin + "GLOVE}=\"1\", ENV{ID_NENDO_HAND}=\"" + std::string(name_of(device)) + "\"";
}

/// Returns what a binding's rule says of the adapter, without the device.
std::string_view adapter_part(std::string_view rule) {
  return rule.substr(0, rule.find(mark));
}

bool binds(std::string_view line, BoundDevice device) {
  return !line.starts_with('#') && line.find(device_part(device)) != std::string_view::npos;
}

template <class Action>
void for_each_line(std::string_view text, Action action) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    action(line);
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
}

template <class Unwanted>
std::string without_lines(std::string_view text, Unwanted unwanted) {
  std::string kept;
  for_each_line(text, [&](std::string_view line) {
    if (!unwanted(line)) kept.append(line) += '\n';
  });
  return kept;
}

Error indistinct(std::string_view port, const std::string& why) {
  return {Errc::usage, std::string(port) + ": " + why +
                           "; bind the socket that it is plugged into: add --by-place"};
}

} // namespace

Result<Binding> make_binding(std::string_view device, std::span<const SerialPort> ports,
                             BoundDevice bound_to, bool by_place) {
  const auto found = std::find_if(ports.begin(), ports.end(),
                                  [&](const SerialPort& port) { return port.device == device; });
  if (found == ports.end()) {
    return Error{Errc::no_device,
                 std::string(device) +
                     ": no such serial port; `nendo devices` lists those there are"};
  }
  if (!found->usb) {
    return Error{Errc::usage, std::string(device) + ": is no USB adapter's, so it keeps its name, "
                                                    "and needs no other"};
  }
  const UsbIdentity& usb = *found->usb;
  if (!by_place && usb.serial.empty())
    return indistinct(device, "its adapter has no serial number");
  Binding binding{bound_to, usb, by_place, false};
  for (const SerialPort& other : ports) {
    if (!other.usb || other.device == device) continue;
    const bool same_adapter = other.usb->place == usb.place;
    binding.by_interface |= same_adapter;
    if (same_adapter && other.usb->interface_number == usb.interface_number) {
      return Error{Errc::usage, std::string(device) + ": only its number distinguishes it from " +
                                    other.device + "; use an adapter with one port"};
    }
    const bool same_kind = id_of(*other.usb) == id_of(usb);
    if (!by_place && !same_adapter && same_kind && other.usb->serial == usb.serial)
      return indistinct(device, other.device + " has the same serial number " + usb.serial);
  }
  return binding;
}

Result<std::string> rule_of(const Binding& binding) {
  const UsbIdentity& usb = binding.adapter;
  const std::string& key = binding.by_place ? usb.place : usb.serial;
  if (!is_plain(key)) {
    return Error{Errc::bad_input, "serial number \"" + key +
                                      "\": udev could take it for something else; bind the socket "
                                      "that the adapter is plugged into: add --by-place"};
  }
  std::array<char, 96> numbers{};
  std::snprintf(numbers.data(), numbers.size(),
                R"(ATTRS{idVendor}=="%04x", ATTRS{idProduct}=="%04x", )", unsigned{usb.vendor_id},
                unsigned{usb.product_id});
  std::string rule = numbers.data();
  rule += (binding.by_place ? "KERNELS==\"" : "ATTRS{serial}==\"") + key + '"';
  if (binding.by_interface) {
    std::array<char, 48> interface{};
    std::snprintf(interface.data(), interface.size(), R"(, ENV{.NENDO_INTERFACE}=="%02x")",
                  static_cast<unsigned>(usb.interface_number) & 0xFFU);
    rule += interface.data();
  }
  return rule + device_part(binding.bound_to);
}

std::string with_binding(std::string_view text, BoundDevice device, std::string_view rule) {
  std::string changed = without_lines(text, [&](std::string_view line) {
    const bool same_adapter =
        line.find(mark) != std::string_view::npos && adapter_part(line) == adapter_part(rule);
    return same_adapter || binds(line, device);
  });
  if (changed.find(".NENDO_INTERFACE}=\"$attr") == std::string::npos) changed.insert(0, head);
  return changed.append(rule) + '\n';
}

std::string without_binding(std::string_view text, BoundDevice device) {
  if (!binding_in(text, device)) return std::string(text);
  std::string kept =
      without_lines(text, [&](std::string_view line) { return binds(line, device); });
  return kept == head ? std::string{} : kept;
}

std::optional<std::string> binding_in(std::string_view text, BoundDevice device) {
  std::optional<std::string> found;
  for_each_line(text, [&](std::string_view line) {
    if (!found && binds(line, device)) found = std::string(line);
  });
  return found;
}

} // namespace nendo::udev
