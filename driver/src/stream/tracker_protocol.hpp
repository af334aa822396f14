#pragma once
// What differs between kinds of trackers.

#include <nendo/driver/tracker.hpp>

#include "stream/stream_protocol.hpp"

namespace nendo::driver {

/// Delivers poses of the stations of its TrackerInfo. One that knows when a pose was measured, but
/// has no clock, sets `measured` in `push()` from `arrival`, and PoseSample::has_device_time is
/// false.
using TrackerProtocol = DeviceProtocol<PoseSample, TrackerInfo>;

} // namespace nendo::driver
