#pragma once
// Gloves that are USB devices of their own, without a serial port.

#include <vector>

#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// Those that are plugged in, found by vendor and product number. Nothing is opened or written to.
std::vector<GloveCandidate> find_usb_gloves();

} // namespace nendo::driver
