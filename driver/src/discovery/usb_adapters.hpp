#pragma once
// The USB-serial adapters that gloves were seen on: what USB numbers tell.

#include <cstdint>
#include <string_view>

namespace nendo::driver {

/// Anything may hang on it, so nothing may be written to it unasked.
struct UsbAdapter {
  std::uint16_t vendor_id;
  std::uint16_t product_id;
  std::string_view maker;
  std::string_view module; ///< the kernel's driver
};

/// nullptr if these numbers are no adapter's that gloves were seen on.
const UsbAdapter* find_usb_adapter(std::uint16_t vendor_id, std::uint16_t product_id) noexcept;

} // namespace nendo::driver
