#include "discovery/usb_bus.hpp"

#include <utility>

#include <libusb.h>

namespace nendo::driver {
namespace {

int set_flag(libusb_context* /*context*/, libusb_device* /*device*/, libusb_hotplug_event /*event*/,
             void* flag) {
  *static_cast<bool*>(flag) = true;
  return 0; // keep calling
}

} // namespace

UsbBus::UsbBus() {
  if (libusb_init(&context_) != 0) context_ = nullptr;
}

UsbBus::~UsbBus() {
  if (context_ != nullptr) libusb_exit(context_); // and its callbacks
}

std::vector<UsbDevice> UsbBus::devices() const {
  std::vector<UsbDevice> found;
  if (context_ == nullptr) return found;
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(context_, &devices);
  for (ssize_t k = 0; k < count; ++k) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(devices[k], &descriptor) != 0) continue;
    found.push_back({descriptor.idVendor, descriptor.idProduct, libusb_get_bus_number(devices[k]),
                     libusb_get_device_address(devices[k])});
  }
  if (count >= 0) libusb_free_device_list(devices, 1);
  return found;
}

bool UsbBus::watch() {
  if (context_ == nullptr || libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) return false;
  constexpr int any = LIBUSB_HOTPLUG_MATCH_ANY;
  watching_ =
      libusb_hotplug_register_callback(
          context_, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT,
          LIBUSB_HOTPLUG_NO_FLAGS, any, any, any, set_flag, &changed_, nullptr) == LIBUSB_SUCCESS;
  return watching_;
}

std::vector<pollfd> UsbBus::wait_on() const {
  std::vector<pollfd> entries;
  if (!watching_) return entries;
  const libusb_pollfd** const list = libusb_get_pollfds(context_);
  for (const libusb_pollfd** at = list; at != nullptr && *at != nullptr; ++at)
    entries.push_back({(*at)->fd, (*at)->events, 0});
  libusb_free_pollfds(list);
  return entries;
}

bool UsbBus::changed() {
  timeval at_once{0, 0};
  if (watching_) libusb_handle_events_timeout_completed(context_, &at_once, nullptr);
  return std::exchange(changed_, false);
}

} // namespace nendo::driver
