#pragma once
// Checks what a mount file may contain, for reader and writer alike.

#include <string>

#include <nendo/hand/tracker_mount.hpp>

namespace nendo::hand {

/// Returns a complaint that begins with the key and names no place, or an empty string if nothing
/// is wrong.
std::string complaint_about(const TrackerMount& mount);

} // namespace nendo::hand
