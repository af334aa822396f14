#pragma once
// Transport to a glove that is a USB device of its own, by libusb. It reads the reports of one HID
// interface, and gets and sets its feature reports. It does not use hidraw, because usbhid makes a
// mouse of a P5.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <nendo/base/result.hpp>

#include "transport/transport.hpp"
#include "transport/usb_identity.hpp"

namespace nendo::driver {

/// Which device to open. An empty member matches every device.
struct UsbWanted {
  UsbId id;
  std::string serial; ///< its serial number
  std::string port;   ///< where it is plugged in, as the kernel names it: 1-4.2
};

/// The part of the device that sends reports.
struct UsbInterface {
  int number = 0;
  std::size_t report_bytes = 0; ///< length of its longest report
};

enum class ControlStatus : std::uint8_t {
  done,
  refused, ///< the device does not know the request, or did not answer in time
  gone,
};

/// Reports are read by several interrupt transfers at a time, so that none is lost while the reader
/// is busy. Their events are handled inside read_some().
class UsbTransport : public Transport {
public:
  /// Returns the device's identity, which never changes. May be called from any thread.
  virtual const UsbIdentity& identity() const noexcept = 0;
  /// Asks for feature report number `report[0]`. Afterwards `report` holds `received` bytes of it,
  /// of which the number is the first.
  virtual ControlStatus get_feature(std::span<std::byte> report, std::size_t& received,
                                    std::chrono::milliseconds timeout) noexcept = 0;
  /// Sets feature report number `report[0]`.
  virtual ControlStatus set_feature(std::span<const std::byte> report,
                                    std::chrono::milliseconds timeout) noexcept = 0;
  // read_some() returns one whole report in one call; its buffer must have 1024 bytes, the
  // longest that an interrupt endpoint sends. write_all() does nothing and returns `timeout`: no
  // glove takes reports at an interrupt endpoint.
};

/// The longest packet of an interrupt endpoint (USB 2.0, 5.7.3).
inline constexpr std::size_t max_usb_report_bytes = 1024;

/// Opens the first device that is `wanted` and not in use, and takes the interface from the
/// kernel's driver until the transport is closed. May block for 0.3 s. Errors: no_device (absent,
/// in use, no such interface), no_permission.
Result<std::unique_ptr<UsbTransport>> open_usb(const UsbWanted& wanted,
                                               const UsbInterface& interface);

} // namespace nendo::driver
