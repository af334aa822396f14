#include <nendo/udev/rules.hpp>

#include <array>
#include <cctype>
#include <cstdio>

#include <nendo/udev/device_table.hpp>

namespace nendo::udev {
namespace {

/// The group that may open gloves on a machine without a screen.
constexpr std::string_view glove_group = "dialout";

// udev(7): ATTRS and SUBSYSTEMS look at the device and its parents, and all of a rule's must match
// the same one of them. Therefore the same line matches a glove's port, its adapter and what lies
// between them.
std::string by_numbers(const UsbGloveModel& model) {
  std::array<char, 96> match{};
  std::snprintf(match.data(), match.size(), R"(ATTRS{idVendor}=="%04x", ATTRS{idProduct}=="%04x")",
                unsigned{model.id.vendor}, unsigned{model.id.product});
  return std::string(match.data()) + R"(, ENV{ID_NENDO_GLOVE}="1", ENV{ID_NENDO_MODEL}=")" +
         std::string(model.name) + "\"\n";
}

/// udev cannot match without regard to case, so "ab" becomes "*[Aa][Bb]*".
std::string anywhere(std::string_view word) {
  std::string pattern = "*";
  for (const char c : word) {
    const auto letter = static_cast<unsigned char>(c);
    pattern += {'[', static_cast<char>(std::toupper(letter)),
                static_cast<char>(std::tolower(letter)), ']'};
  }
  return pattern + '*';
}

std::string by_name(std::string_view word) {
  std::string rules;
  for (const std::string_view attribute : {"manufacturer", "product"}) {
    const std::string match = "ATTRS{" + std::string(attribute) + "}==\"" + anywhere(word) + "\", ";
    rules += match + "ENV{ID_NENDO_GLOVE}=\"1\"\n";
    rules += match + "ATTRS{serial}==\"?*\", ENV{.NENDO_SERIAL}=\"$attr{serial}\"\n";
  }
  return rules;
}

/// Returns the rules for event nodes. An input device with six axes has the codes 0 to 5 of ABS_
/// or, with older kernels, of REL_, whose bits are the last digits of the device's capabilities.
std::string space_mouse_rules() {
  std::string rules;
  for (const SpaceMouseNumbers& numbers : space_mouse_numbers())
    for (const std::string axes : {"abs", "rel"})
      rules += "KERNEL==\"event*\", ATTRS{id/vendor}==\"" + std::string(numbers.vendor) +
               "\", ATTRS{id/product}==\"" + std::string(numbers.products) +
               "\", ATTRS{capabilities/" + axes + "}==\"*3f\", ENV{ID_NENDO_TRACKER}=\"1\"\n";
  return rules;
}

std::string adapters_left_out() {
  std::string list;
  for (const UsbAdapter& adapter : usb_adapters())
    list += (list.empty() ? "" : ", ") + to_string(adapter.id);
  return list;
}

std::string identification() {
  std::string text(rule_mark);
  text +=
      "which devices are data gloves and SpaceMice. Changes to this file are lost at the\n"
      "# next update. `nendo udev bind` writes to 60-nendo-local.rules, which udev reads first.\n"
      "ACTION==\"remove\", GOTO=\"nendo_end\"\n"
      "SUBSYSTEM==\"input\", GOTO=\"nendo_input\"\n"
      "SUBSYSTEMS==\"usb\", GOTO=\"nendo_usb\"\n" // != would hold if any parent is another
      "GOTO=\"nendo_end\"\n\n"
      "# SpaceMice, which move wrists. Their makers' keyboards and mice do not have six axes.\n"
      "LABEL=\"nendo_input\"\n" +
      space_mouse_rules() +
      "GOTO=\"nendo_end\"\n\n"
      "# Gloves with USB numbers of their own.\n"
      "LABEL=\"nendo_usb\"\n";
  for (const UsbGloveModel& model : usb_glove_models())
    text += by_numbers(model);
  text += "\n# Devices that call themselves a glove.\n";
  for (const std::string_view name : glove_names())
    text += by_name(name);
  text += "\n# USB-serial adapters are not listed, because anything may be connected to them:\n# " +
          adapters_left_out() +
          ".\n"
          "# `nendo udev bind PORT --as right` binds one of those by its serial number.\n"
          "ENV{ID_NENDO_GLOVE}!=\"1\", ENV{ID_NENDO_TRACKER}!=\"1\", GOTO=\"nendo_end\"\n\n"
          "# ModemManager would hold a new port for 10 to 20 s and send modem commands to it.\n"
          "SUBSYSTEM==\"usb\", ENV{DEVTYPE}==\"usb_device\", ENV{ID_MM_DEVICE_IGNORE}=\"1\"\n"
          "SUBSYSTEM==\"tty\", ENV{ID_MM_PORT_IGNORE}=\"1\"\n\n"
          "# Links that stay the same. A device's own text must not lead out of the folder.\n"
          "SUBSYSTEM==\"tty\", ENV{ID_NENDO_HAND}==\"left|right\", "
          "SYMLINK+=\"nendo/$env{ID_NENDO_HAND}\"\n"
          "SUBSYSTEM==\"tty\", ENV{ID_NENDO_TRACKER}==\"1\", SYMLINK+=\"nendo/tracker\"\n"
          "SUBSYSTEM==\"tty\", ENV{ID_NENDO_HAND}==\"\", ENV{.NENDO_SERIAL}==\"?*\", "
          "ENV{.NENDO_SERIAL}!=\"*/*\", SYMLINK+=\"nendo/glove-$env{.NENDO_SERIAL}\"\n\n"
          "# FTDI adapters delay short replies by 16 ms by default.\n"
          "SUBSYSTEM==\"usb-serial\", DRIVER==\"ftdi_sio\", ATTR{latency_timer}!=\"1\", "
          "ATTR{latency_timer}=\"1\"\n"
          "LABEL=\"nendo_end\"\n";
  return text;
}

// The number is below 73, because there systemd turns the tag into the permission. The USB device
// itself is granted only where the glove has no port, so that no user can detach a port's
// kernel driver.
std::string grant() {
  const std::string rights =
      "TAG+=\"uaccess\", GROUP=\"" + std::string(glove_group) + "\", MODE=\"0660\"\n";
  return std::string(rule_mark) +
         "who may open data gloves and trackers. Changes to this file are lost at the next "
         "update.\n"
         "# uaccess: the user at the screen; the group: a machine without a screen. Input devices "
         "keep their group.\n"
         "ACTION==\"remove\", GOTO=\"nendo_uaccess_end\"\n"
         "ENV{ID_NENDO_GLOVE}!=\"1\", ENV{ID_NENDO_TRACKER}!=\"1\", GOTO=\"nendo_uaccess_end\"\n"
         "SUBSYSTEM==\"tty\", " +
         rights +
         "SUBSYSTEM==\"usb\", ENV{DEVTYPE}==\"usb_device\", ENV{ID_NENDO_MODEL}==\"?*\", " +
         rights +
         "SUBSYSTEM==\"input\", TAG+=\"uaccess\"\n"
         "LABEL=\"nendo_uaccess_end\"\n";
}

} // namespace

std::vector<RuleText> shipped_rules() {
  return {{"60-nendo.rules", identification()}, {"61-nendo-uaccess.rules", grant()}};
}

} // namespace nendo::udev
