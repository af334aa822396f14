#include "discovery/usb_adapters.hpp"

#include <algorithm>
#include <array>

namespace nendo::driver {
namespace {

// 0403:6001 is also a CyberGlove III itself; Prolific's is what early users plug gloves into; the
// other two are the chips of hobbyists' gloves.
constexpr std::array usb_adapters{
    UsbAdapter{0x0403, 0x6001, "FTDI", "ftdi_sio"},
    UsbAdapter{0x067B, 0x2303, "Prolific", "pl2303"},
    UsbAdapter{0x10C4, 0xEA60, "Silicon Labs", "cp210x"},
    UsbAdapter{0x1A86, 0x7523, "WCH", "ch341"},
};

} // namespace

const UsbAdapter* find_usb_adapter(std::uint16_t vendor_id, std::uint16_t product_id) noexcept {
  const auto* const found =
      std::find_if(usb_adapters.begin(), usb_adapters.end(), [&](const UsbAdapter& adapter) {
        return adapter.vendor_id == vendor_id && adapter.product_id == product_id;
      });
  return found != usb_adapters.end() ? found : nullptr;
}

} // namespace nendo::driver
