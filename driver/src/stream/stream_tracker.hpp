#pragma once
// A tracker that sends a stream of bytes.

#include <memory>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/tracker.hpp>

#include "stream/device_stream.hpp"
#include "stream/tracker_protocol.hpp"

namespace nendo::driver {

/// Opens the port and identifies the tracker, by `deadline`. Errors: those of `open_port` and of
/// TrackerProtocol::identify.
Result<std::unique_ptr<Tracker>> open_stream_tracker(const std::string& source, OpenPort open_port,
                                                     std::unique_ptr<TrackerProtocol> protocol,
                                                     HostTime deadline);

} // namespace nendo::driver
