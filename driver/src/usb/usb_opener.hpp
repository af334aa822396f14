#pragma once
// What the drivers of USB gloves share when they open a device.

#include <vector>

#include <nendo/driver/glove.hpp>

#include "stream/stream_glove.hpp"
#include "transport/usb_transport.hpp"

namespace nendo::driver {

/// Returns a function that opens the device that is `wanted`. Later calls open the same device
/// wherever it is plugged in; it is known by its serial number, or by its port if it has none.
OpenPort usb_opener(UsbWanted wanted, const UsbInterface& interface);

/// Returns what the kernel knows of the device: its numbers, port, maker, product and serial
/// number.
std::vector<GloveFact> facts_of(const UsbIdentity& identity);

} // namespace nendo::driver
