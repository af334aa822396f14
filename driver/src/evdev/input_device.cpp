#include "evdev/input_device.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <system_error>
#include <utility>

#include <linux/input.h>
#include <unistd.h>

#include <nendo/base/advised_command.hpp>
#include <nendo/base/endings.hpp>
#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>
#include <nendo/driver/device_spec.hpp>
#include <nendo/udev/device_table.hpp>

#include "transport/open_transport.hpp"
#include "transport/sysfs.hpp"
#include "transport/udev_devices.hpp"

namespace nendo::driver::evdev {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view node_prefix = "event";
constexpr std::string_view nodes_folder = "/dev/input";
constexpr std::string_view class_folder = "/sys/class/input";

fs::path class_entry(const std::string& node) {
  return fs::path(class_folder) / node;
}

bool has_bit(std::string_view bitmap, unsigned bit) noexcept {
  constexpr unsigned word_bits = 8 * sizeof(unsigned long);
  std::string_view word = trimmed(bitmap.substr(0, bitmap.find('\n')));
  for (unsigned skip = bit / word_bits; skip > 0; --skip) {
    const std::size_t blank = word.rfind(' ');
    if (blank == std::string_view::npos) return false;
    word = word.substr(0, blank);
  }
  word.remove_prefix(word.rfind(' ') + 1); // npos + 1 is 0
  const auto bits = number_in<unsigned long>(word, 16);
  return bits && ((*bits >> (bit % word_bits)) & 1U) != 0;
}

bool has_bits(std::string_view bitmap, std::initializer_list<unsigned> bits) noexcept {
  return std::all_of(bits.begin(), bits.end(), [&](unsigned bit) { return has_bit(bitmap, bit); });
}

/// Returns 5 for event5.
std::optional<unsigned> number_of_node(std::string_view node) noexcept {
  if (!node.starts_with(node_prefix)) return std::nullopt;
  return number_in<unsigned>(node.substr(node_prefix.size()));
}

bool is_node(const std::string& path) {
  const fs::path node(path);
  std::error_code ignored;
  return node.parent_path() == nodes_folder && number_of_node(node.filename().string()) &&
         fs::exists(class_entry(node.filename().string()), ignored);
}

std::optional<InputDevice> device_at(const std::string& node) {
  const fs::path folder = class_entry(node) / "device";
  const fs::path bitmaps = folder / "capabilities";
  const InputBitmaps read{read_text(folder / "properties"), read_text(bitmaps / "key"),
                          read_text(bitmaps / "rel"), read_text(bitmaps / "abs")};
  const auto kind = kind_of(read);
  if (!kind) return std::nullopt;
  return InputDevice{(fs::path(nodes_folder) / node).string(),
                     read_line(folder / "name"),
                     read_line(folder / "id/vendor"),
                     read_line(folder / "id/product"),
                     read_line(folder / "id/bustype") == "0003", // BUS_USB
                     *kind,
                     first_button_of(read.keys)};
}

std::string in_words(const std::vector<InputDevice>& devices) {
  std::string list;
  for (const InputDevice& device : devices)
    list += (list.empty() ? "" : ", ") + device.name + " (" + device.node + ", " +
            std::string(name_of(device.kind)) + ")";
  return list;
}

std::string existing() {
  const std::string list = in_words(list_input_devices());
  return list.empty() ? "there is none; plug in a SpaceMouse, a gamepad or a second mouse"
                      : "there are: " + list;
}

Result<InputDevice> find_by_path(const std::string& path) {
  const fs::path node(resolve_input(path));
  if (!is_node(node.string()))
    return Error{Errc::no_device, path + ": no such input device; " + existing()};
  auto device = device_at(node.filename().string());
  if (device) return *std::move(device);
  return Error{Errc::no_device,
               path + " (" + read_line(class_entry(node.filename().string()) / "device/name") +
                   ") has neither six axes, nor a gamepad's sticks, nor a mouse's "
                   "movement; " +
                   existing()};
}

} // namespace

std::string_view name_of(InputKind kind) noexcept {
  constexpr std::array<std::string_view, 4> names{"six axes", "six axes", "gamepad", "mouse"};
  return names[static_cast<std::size_t>(kind)];
}

std::optional<InputKind> kind_of(const InputBitmaps& bitmaps) noexcept {
  // Gamepads have a second device for their motion sensors, with the same axes.
  if (has_bit(bitmaps.properties, INPUT_PROP_ACCELEROMETER)) return std::nullopt;
  if (has_bit(bitmaps.keys, BTN_TOUCH)) return std::nullopt;
  if (has_bits(bitmaps.relative, {REL_X, REL_Y, REL_Z, REL_RX, REL_RY, REL_RZ}))
    return InputKind::six_relative;
  if (has_bit(bitmaps.keys, BTN_GAMEPAD) &&
      has_bits(bitmaps.absolute, {ABS_X, ABS_Y, ABS_RX, ABS_RY}))
    return InputKind::gamepad;
  if (has_bits(bitmaps.absolute, {ABS_X, ABS_Y, ABS_Z, ABS_RX, ABS_RY, ABS_RZ}))
    return InputKind::six_absolute;
  if (has_bit(bitmaps.keys, BTN_MOUSE) && has_bits(bitmaps.relative, {REL_X, REL_Y}))
    return InputKind::mouse;
  return std::nullopt;
}

std::uint16_t first_button_of(std::string_view keys) noexcept {
  for (unsigned code = BTN_MISC; code < KEY_OK; ++code) // between them are buttons only
    if (has_bit(keys, code)) return static_cast<std::uint16_t>(code);
  return 0;
}

std::vector<InputDevice> list_input_devices() {
  std::vector<std::string> nodes;
  for (const UdevDevice& device : list_udev_devices("input"))
    if (const std::string name = udev_device_get_sysname(device.get()); number_of_node(name))
      nodes.push_back(name);
  std::sort(nodes.begin(), nodes.end(), [](const std::string& a, const std::string& b) {
    return *number_of_node(a) < *number_of_node(b);
  });
  std::vector<InputDevice> devices;
  for (const std::string& node : nodes)
    if (auto device = device_at(node)) devices.push_back(*std::move(device));
  return devices;
}

Result<InputDevice> find_input_device(const std::string& name) {
  if (name.empty())
    return Error{Errc::usage,
                 "name an input device or its path, e.g. evdev:/dev/input/event5; " + existing()};
  if (name.front() == '/') return find_by_path(name);
  if (number_of_node(name)) return find_by_path((fs::path(nodes_folder) / name).string());
  std::vector<InputDevice> devices = list_input_devices();
  std::erase_if(devices, [&](const InputDevice& device) {
    return to_lower(device.name).find(to_lower(name)) == std::string::npos;
  });
  const auto has_this_name = [&](const InputDevice& device) { return device.name == name; };
  if (std::count_if(devices.begin(), devices.end(), has_this_name) == 1)
    return *std::find_if(devices.begin(), devices.end(), has_this_name);
  if (devices.size() == 1) return devices.front();
  if (devices.empty())
    return Error{Errc::no_device,
                 "no input device named " + in_quotes(name) + " can move a wrist; " + existing()};
  return Error{Errc::usage, in_quotes(name) +
                                " is in the names of several devices; give the path of " +
                                "one: " + in_words(devices)};
}

std::string name_to_type(const InputDevice& device, const std::vector<InputDevice>& devices,
                         const std::string& link) {
  const std::string& name = device.name;
  const auto has_this_name = [&](const InputDevice& other) { return other.name == name; };
  const auto spec = parse_device_spec("evdev:" + name);
  const bool is_path = name.starts_with('/') || number_of_node(name);
  const bool is_usable = spec && spec->target == name && !name.empty() && !is_path &&
                         std::count_if(devices.begin(), devices.end(), has_this_name) == 1;
  return is_usable ? name : link.empty() ? device.node : link;
}

std::string resolve_input(const std::string& path) {
  return follow_links(path, is_node);
}

bool is_space_mouse(const InputDevice& device) noexcept {
  const bool has_six_axes =
      device.kind == InputKind::six_absolute || device.kind == InputKind::six_relative;
  return has_six_axes && udev::numbers_a_space_mouse(device.vendor_id, device.product_id);
}

PortAccess input_access(const InputDevice& device) {
  if (::access(device.node.c_str(), R_OK) == 0) return {true, "you", ""};
  return refused_input(device);
}

PortAccess refused_input(const InputDevice& device) {
  PortAccess access = refused_access(device.node);
  if (access.who.empty()) return access; // it has no node
  if (is_space_mouse(device)) {
    access.remedy = as_root("udev install") + " for the user at the screen; or " + access.remedy;
  } else {
    access.remedy += "; or, for this device alone, put this line into "
                     "/etc/udev/rules.d/61-wrist.rules and plug it in again: SUBSYSTEM==\"input\", "
                     "KERNEL==\"event*\", ATTRS{id/vendor}==\"" +
                     device.vendor_id + "\", ATTRS{id/product}==\"" + device.product_id +
                     "\", TAG+=\"uaccess\"";
  }
  return access;
}

} // namespace nendo::driver::evdev
