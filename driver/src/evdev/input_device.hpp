#pragma once
// The input devices of this machine that can move a wrist, as /sys/class/input lists them. No node
// is opened, so devices that this user may not open are listed too.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

#include "transport/port_access.hpp"

namespace nendo::driver::evdev {

/// What a device's axes mean (linux/input-event-codes.h; Documentation/input/gamepad.rst).
enum class InputKind : std::uint8_t {
  six_absolute, ///< ABS_X to ABS_RZ are deflections of a cap: SpaceMouse, joystick
  six_relative, ///< REL_X to REL_RZ are deflections: SpaceMouse with an older kernel
  gamepad,      ///< ABS_X, ABS_Y and ABS_RX, ABS_RY are sticks, ABS_Z and ABS_RZ triggers
  mouse,        ///< REL_X, REL_Y and REL_WHEEL are movements
};

/// Returns "six axes", "gamepad" or "mouse".
std::string_view name_of(InputKind kind) noexcept;

struct InputDevice {
  std::string node;                  ///< e.g. /dev/input/event5
  std::string name;                  ///< its own, printable
  std::string vendor_id, product_id; ///< four hexadecimal digits each
  bool is_usb = false;               ///< plugged in; false: Bluetooth, built in
  InputKind kind = InputKind::mouse;
  std::uint16_t first_button = 0; ///< the lowest BTN_ code; 0 if it has no button
};

/// Bitmaps of a device as /sys has them: hexadecimal words of the size of a long, the highest
/// first.
struct InputBitmaps {
  std::string properties, keys, relative, absolute;
};
/// Returns nothing for other devices, also for motion sensors, touchpads and tablets.
std::optional<InputKind> kind_of(const InputBitmaps& bitmaps) noexcept;
std::uint16_t first_button_of(std::string_view keys) noexcept;

/// Returns the devices, sorted by the number of their node.
std::vector<InputDevice> list_input_devices();

/// Returns the device of this name: the path of its node or of a link to it, the node's own name
/// (event5), or a part of the device's name that no other device has, in upper or lower case.
/// Errors: no_device, usage (empty, or several devices); both list the devices that there are.
Result<InputDevice> find_input_device(const std::string& name);
/// Returns what find_input_device() takes for this one of `devices`: its name, if no other device
/// has it and a specification can express it; else `link`, or its node if `link` is empty.
std::string name_to_type(const InputDevice& device, const std::vector<InputDevice>& devices,
                         const std::string& link);
/// Follows links to the node of an input device. Returns a path that leads nowhere unchanged.
std::string resolve_input(const std::string& path);

bool is_space_mouse(const InputDevice& device) noexcept;
/// Returns who may read the device's events, and the remedy if this user may not.
PortAccess input_access(const InputDevice& device);
/// Returns the same for a device that could not be opened, independent of its mode.
PortAccess refused_input(const InputDevice& device);

} // namespace nendo::driver::evdev
