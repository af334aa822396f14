#pragma once
// The list behind find_gloves() and DeviceWatcher: ports and USB devices, joined and judged.

#include <vector>

#include <nendo/driver/devices.hpp>

#include "discovery/usb_bus.hpp"

namespace nendo::driver {

/// As find_gloves(), but without the holders, which take longest.
std::vector<GloveCandidate> list_candidates(const UsbBus& usb);

/// Fills in who holds them.
void add_holders(std::vector<GloveCandidate>& candidates);

/// False while udev still works on the device: its node, links or permissions may yet come.
bool is_settled(const GloveCandidate& candidate);

} // namespace nendo::driver
