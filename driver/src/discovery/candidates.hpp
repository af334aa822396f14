#pragma once
// The list behind find_devices() and DeviceWatcher: all devices that may be gloves or trackers.

#include <vector>

#include <nendo/driver/devices.hpp>

#include "transport/port_access.hpp"

namespace nendo::driver {

/// Returns what find_devices() does, but without the holders, which take longest to find.
std::vector<DeviceCandidate> list_candidates();

/// Returns the input devices among them.
std::vector<DeviceCandidate> list_input_candidates();

/// Fills in who may open the candidate.
void set_access(DeviceCandidate& candidate, PortAccess access);
/// Fills in which programs hold the candidates' devices.
void add_holders(std::vector<DeviceCandidate>& candidates);

/// Returns false while udev still works on the device: its node, links or permissions may yet come.
bool is_settled(const DeviceCandidate& candidate);

} // namespace nendo::driver
