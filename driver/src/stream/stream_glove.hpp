#pragma once
// A glove that sends a stream of bytes. It runs the reader thread, counts, and handles silence,
// loss and return of the device. The GloveProtocol knows what the bytes mean.

#include <functional>
#include <memory>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/glove.hpp>

#include "stream/glove_protocol.hpp"
#include "transport/transport.hpp"

namespace nendo::driver {

/// Opens the device. The reader thread calls it again whenever the device has vanished.
using OpenPort = std::function<Result<std::unique_ptr<Transport>>()>;

/// How long opening a glove may take in all.
inline constexpr std::chrono::milliseconds open_budget{4000};

/// Opens the port and identifies the glove, by `deadline`. Errors: those of `open_port` and of
/// GloveProtocol::identify.
Result<std::unique_ptr<Glove>> open_stream_glove(const std::string& source, OpenPort open_port,
                                                 std::unique_ptr<GloveProtocol> protocol,
                                                 HostTime deadline);

} // namespace nendo::driver
