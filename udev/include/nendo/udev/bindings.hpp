#pragma once
// Bindings: rules by which a user declares that an adapter belongs to a glove of the left or the
// right hand, or to a tracker. These functions make and change text; they write no file.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/udev/usb_identity.hpp>

namespace nendo::udev {

/// The file of the bindings, one rule a line. udev reads it before 60-nendo.rules.
inline constexpr std::string_view binding_file_name = "60-nendo-local.rules";

/// The devices that an adapter can be bound to. The link to its port has this name, in /dev/nendo.
enum class BoundDevice : std::uint8_t { left_glove, right_glove, tracker };
inline constexpr BoundDevice bound_devices[]{BoundDevice::left_glove, BoundDevice::right_glove,
                                             BoundDevice::tracker};
/// Returns "left", "right" or "tracker".
constexpr std::string_view name_of(BoundDevice device) noexcept {
  constexpr std::string_view names[]{"left", "right", "tracker"};
  return names[static_cast<std::size_t>(device)];
}

/// A serial port that is plugged in.
struct SerialPort {
  std::string device;             ///< e.g. /dev/ttyUSB0
  std::optional<UsbIdentity> usb; ///< its adapter; nullopt if it has none
};

struct Binding {
  BoundDevice bound_to = BoundDevice::right_glove;
  UsbIdentity adapter;
  bool by_place = false;     ///< known by the socket that it is plugged into, else by its serial
  bool by_interface = false; ///< only one port of an adapter that has several
};

/// Returns the binding of the port `device`. `ports` are all ports that are plugged in;
/// they show whether the serial number is this adapter's alone. Errors: no_device (`device` is not
/// among them), usage (it has no adapter, or its adapter is not distinct from another one; the
/// message says what to do).
NENDO_API Result<Binding> make_binding(std::string_view device, std::span<const SerialPort> ports,
                                       BoundDevice bound_to, bool by_place);

/// Returns the binding's rule, one line without the newline. Error: bad_input, if udev could take
/// the adapter's serial number for something else.
NENDO_API Result<std::string> rule_of(const Binding& binding);

/// Returns the file `text` with `rule` as the binding of this device. It replaces an earlier
/// binding of the device or of the same adapter; every other line stays. An empty text becomes a
/// whole file.
NENDO_API std::string with_binding(std::string_view text, BoundDevice device,
                                   std::string_view rule);
/// Returns the file `text` without that device's binding: the same text if there is none, an empty
/// text if nothing of the user's is left.
NENDO_API std::string without_binding(std::string_view text, BoundDevice device);
/// Returns the rule of that device's binding; nullopt if there is none.
NENDO_API std::optional<std::string> binding_in(std::string_view text, BoundDevice device);

} // namespace nendo::udev
