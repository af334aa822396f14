#pragma once
// The table of devices: all that USB numbers and names say about gloves and SpaceMice. The driver
// looks devices up in it, and the udev rules are made from it, so the two cannot disagree.

#include <span>
#include <string>
#include <string_view>

#include <nendo/base/api.hpp>
#include <nendo/udev/usb_identity.hpp>

namespace nendo::udev {

/// A glove that is a USB device of its own.
struct UsbGloveModel {
  UsbId id;
  std::string_view name;
};

/// A USB-serial adapter that gloves were seen on. Anything may be connected to it, so nothing is
/// written to it unasked, and no rule matches it by these numbers.
struct UsbAdapter {
  UsbId id;
  std::string_view maker;
  std::string_view module; ///< the kernel's driver
};

/// The numbers of SpaceMice of one maker. Its keyboards and mice also have such numbers, so a
/// SpaceMouse is an input device that has six axes as well.
struct SpaceMouseNumbers {
  std::string_view vendor;   ///< four hexadecimal digits, in lower case
  std::string_view products; ///< the same, with ? for a digit that does not matter
};

NENDO_API std::span<const UsbGloveModel> usb_glove_models() noexcept;
NENDO_API std::span<const UsbAdapter> usb_adapters() noexcept;
NENDO_API std::span<const SpaceMouseNumbers> space_mouse_numbers() noexcept;
/// Returns words, in lower case, that only a glove has in its own description.
NENDO_API std::span<const std::string_view> glove_names() noexcept;

/// Returns the name of the glove with these numbers; an empty text if nendo has no driver for it.
NENDO_API std::string_view usb_glove_name(UsbId id) noexcept;
/// Returns nullptr if gloves were seen on no adapter with these numbers.
NENDO_API const UsbAdapter* find_usb_adapter(UsbId id) noexcept;
/// Returns true if the text contains one of glove_names(), in upper or lower case.
NENDO_API bool names_a_glove(std::string text);
/// Returns true if these numbers, as space_mouse_numbers() has them, are those of a SpaceMouse.
NENDO_API bool numbers_a_space_mouse(std::string_view vendor, std::string_view product) noexcept;

} // namespace nendo::udev
