#pragma once
// The list behind find_gloves() and DeviceWatcher: all ports and USB devices that may be gloves.

#include <vector>

#include <nendo/driver/devices.hpp>

namespace nendo::driver {

/// Returns what find_gloves() does, but without the holders, which take longest to find.
std::vector<GloveCandidate> list_candidates();

/// Fills in which programs hold the candidates' devices.
void add_holders(std::vector<GloveCandidate>& candidates);

/// Returns false while udev still works on the device: its node, links or permissions may yet come.
bool is_settled(const GloveCandidate& candidate);

} // namespace nendo::driver
