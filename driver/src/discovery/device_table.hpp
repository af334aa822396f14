#pragma once
// The table of devices: all that USB numbers and names tell of gloves. find_gloves() looks devices
// up in it and the udev rules are made from it, so the two cannot disagree.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "transport/usb_device.hpp"

namespace nendo::driver {

/// A glove that is a USB device of its own.
struct UsbGloveModel {
  UsbId id;
  std::string_view name;
};

/// A USB-serial adapter that gloves were seen on. Anything may hang on it, so nothing may be
/// written to it unasked, and no rule may claim it by these numbers.
struct UsbAdapter {
  UsbId id;
  std::string_view maker;
  std::string_view module; ///< the kernel's driver
};

std::span<const UsbGloveModel> usb_glove_models() noexcept;
std::span<const UsbAdapter> usb_adapters() noexcept;
/// Words, in lower case, that only a glove has in its own description.
std::span<const std::string_view> glove_names() noexcept;

/// What the glove with this number is called; empty if nendo has no driver for it.
std::string_view usb_glove_name(UsbId id) noexcept;
/// nullptr if these numbers are no adapter's that gloves were seen on.
const UsbAdapter* find_usb_adapter(UsbId id) noexcept;
/// True if the text has one of glove_names() in it, in any case.
bool names_a_glove(std::string text);

} // namespace nendo::driver
