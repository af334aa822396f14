#pragma once
// libusb's view of the machine: the USB devices that are there, and a wake-up when that changes.
// Opens no device.

#include <cstdint>
#include <vector>

#include <poll.h>

struct libusb_context;

namespace nendo::driver {

struct UsbDevice {
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  unsigned bus = 0;
  unsigned address = 0;
};

/// Used by one thread at a time.
class UsbBus {
public:
  UsbBus();
  ~UsbBus();
  UsbBus(const UsbBus&) = delete;
  UsbBus& operator=(const UsbBus&) = delete;

  /// Empty on a machine without USB.
  std::vector<UsbDevice> devices() const;

  /// Begins to notice arrivals and departures. False: no USB here, or libusb has no hot-plug here.
  bool watch();
  /// What to poll() for while it watches.
  std::vector<pollfd> wait_on() const;
  /// Does what is due, without waiting. True if a device arrived or left since the last call.
  bool changed();

private:
  libusb_context* context_ = nullptr; ///< null: a machine without USB
  bool watching_ = false;
  bool changed_ = false;
};

} // namespace nendo::driver
