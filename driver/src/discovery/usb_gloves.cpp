#include "discovery/usb_gloves.hpp"

#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>

#include <libusb.h>
#include <unistd.h>

namespace nendo::driver {
namespace {

struct UsbGlove {
  std::uint16_t vendor_id;
  std::optional<std::uint16_t> product_id; ///< any, if the vendor makes nothing but gloves
  const char* name;
};

constexpr std::array usb_gloves{
    UsbGlove{0x0D7F, 0x0100, "Essential Reality P5"},
    UsbGlove{0x5D70, std::nullopt, "5DT Data Glove Ultra"},
};

GloveCandidate describe(libusb_device* device, const UsbGlove& glove) {
  GloveCandidate candidate;
  std::array<char, 32> path{};
  std::snprintf(path.data(), path.size(), "/dev/bus/usb/%03u/%03u",
                unsigned{libusb_get_bus_number(device)},
                unsigned{libusb_get_device_address(device)});
  candidate.device = path.data();
  candidate.description = glove.name;
  candidate.reason = "its USB number is that of a glove, for which nendo has no driver yet";
  candidate.may_open = ::access(path.data(), R_OK | W_OK) == 0;
  return candidate;
}

} // namespace

std::vector<GloveCandidate> find_usb_gloves() {
  std::vector<GloveCandidate> found;
  libusb_context* context = nullptr;
  if (libusb_init(&context) != 0) return found; // a machine without USB has no USB gloves
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(context, &devices);
  for (ssize_t k = 0; k < count; ++k) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(devices[k], &descriptor) != 0) continue;
    for (const UsbGlove& glove : usb_gloves) {
      const bool same_product = !glove.product_id || *glove.product_id == descriptor.idProduct;
      if (glove.vendor_id == descriptor.idVendor && same_product) {
        found.push_back(describe(devices[k], glove));
      }
    }
  }
  if (count >= 0) libusb_free_device_list(devices, 1);
  libusb_exit(context);
  return found;
}

} // namespace nendo::driver
