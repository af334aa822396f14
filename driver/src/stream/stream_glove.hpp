#pragma once
// A glove that sends a stream of bytes.

#include <memory>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/glove.hpp>

#include "stream/device_stream.hpp"
#include "stream/glove_protocol.hpp"

namespace nendo::driver {

/// Opens the port and identifies the glove, by `deadline`. Errors: those of `open_port` and of
/// GloveProtocol::identify.
Result<std::unique_ptr<Glove>> open_stream_glove(const std::string& source, OpenPort open_port,
                                                 std::unique_ptr<GloveProtocol> protocol,
                                                 HostTime deadline);

} // namespace nendo::driver
