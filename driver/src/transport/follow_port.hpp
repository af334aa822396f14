#pragma once
// Finds a port again when it comes back under another name: a glove that was plugged in as ttyUSB0
// may return as ttyUSB1, and another adapter may have taken its name.

#include <functional>
#include <memory>
#include <string>

#include <nendo/base/result.hpp>

#include "transport/transport.hpp"

namespace nendo::driver {

/// Returns a function that opens `path`, as open_transport() does and with its errors. The first
/// call that succeeds remembers the adapter: vendor, product, serial number and port, or where it
/// is plugged in if it has no serial number of its own. Later calls open the port that this adapter
/// has now; the error is no_device if there is none, also if another adapter has taken the name.
/// Ports without an adapter (UARTs, Bluetooth, pseudo-terminals) are opened by the same path each
/// time. An FTDI adapter's latency timer is shortened at each opening; if that is not permitted, a
/// line of log gives the remedy. Calls may block for half a second, and must not overlap.
std::function<Result<std::unique_ptr<Transport>>()> follow_port(std::string path, int baud);

} // namespace nendo::driver
