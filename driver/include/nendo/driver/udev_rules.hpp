#pragma once
// The udev rules that make gloves usable without root: what is a glove, its links in /dev/nendo,
// who may open it, and that ModemManager keeps off. All of this makes text; nothing is written.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/devices.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::driver {

/// A file of rules, by its name in a folder like /etc/udev/rules.d.
struct UdevFile {
  std::string_view name;
  std::string text;
};

/// 60-nendo.rules, which identifies gloves, and 61-nendo-uaccess.rules, which grants them to the
/// user at the screen and to a group. From the table of devices; generic USB-serial adapters are in
/// neither.
std::vector<UdevFile> udev_files();
/// The first line of those files begins with this, and of no others.
inline constexpr std::string_view udev_file_mark = "# Made by nendo: ";
/// The group that may open gloves on a machine without a screen.
inline constexpr std::string_view glove_group = "dialout";

/// Where bindings stand, one a line; read before 60-nendo.rules.
inline constexpr std::string_view binding_file_name = "60-nendo-local.rules";

/// An adapter that a user calls a glove's.
struct UdevBinding {
  Side side = Side::right;
  UsbIdentity adapter;
  bool by_place = false;     ///< known by the socket that it is plugged into, else by its serial
  bool by_interface = false; ///< one port of an adapter that has several
};

/// The binding of a port, by name or link. `ports` are those that are plugged in, which show
/// whether the serial number is this adapter's alone. Error: no_device (no such port, or not at
/// USB), usage (nothing tells this adapter from another one; says what to do).
Result<UdevBinding> make_binding(std::string_view port, std::span<const GloveCandidate> ports,
                                 Side side, bool by_place);

/// Its rule, one line without the newline. Error: bad_input, if what the adapter says of itself
/// could mean something else to udev.
Result<std::string> rule_of(const UdevBinding& binding);

/// The file `text` with `rule` as the binding of this hand, in place of an earlier one of the hand
/// or of the same adapter. Every other line stays. An empty text becomes a whole file.
std::string with_binding(std::string_view text, Side side, std::string_view rule);
/// Without that hand's binding; the same text if there is none, an empty one if nothing is left.
std::string without_binding(std::string_view text, Side side);
/// The rule of that hand's binding; nullopt if there is none.
std::optional<std::string> binding_in(std::string_view text, Side side);

} // namespace nendo::driver
