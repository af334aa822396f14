#pragma once
// The driver of a FASTRAK over anything that looks like a serial port.

#include <memory>

#include "polhemus/polhemus_options.hpp"
#include "stream/tracker_protocol.hpp"

namespace nendo::driver::fastrak {

/// Makes the protocol of a FASTRAK that is to be set up as `options` say. Without Options::baud,
/// the line has the first of `bauds` until identify() has found another rate.
std::unique_ptr<TrackerProtocol> make_protocol(polhemus::Options options);

} // namespace nendo::driver::fastrak
