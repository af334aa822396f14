#pragma once
// The driver of CyberGlove I, II and III over anything that looks like a serial port.

#include <memory>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

#include "cyberglove/cyberglove_options.hpp"
#include "stream/stream_glove.hpp"

namespace nendo::driver::cyberglove {

/// Opens `serial:PATH`, as the table of drivers wants it. `side` is not used, because the glove
/// says which hand it is.
Result<std::unique_ptr<Glove>> open_serial(const DeviceSpec& spec, std::optional<Side> side);
/// Does the same, and gives up at `deadline`.
Result<std::unique_ptr<Glove>> open_serial_by(const DeviceSpec& spec, HostTime deadline);

/// Opens the port, finds the line rate unless `options` name it, and identifies and sets up the
/// glove. The options are set again after every interruption. Errors: those of `open_port`;
/// no_device; usage, if the glove or its line cannot do what an option asks for.
NENDO_API Result<std::unique_ptr<Glove>> open_cyberglove(const std::string& source,
                                                         OpenPort open_port,
                                                         const cyberglove::Options& options,
                                                         HostTime deadline);

} // namespace nendo::driver::cyberglove
