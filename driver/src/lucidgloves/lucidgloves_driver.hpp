#pragma once
// LucidGloves, and whatever else speaks OpenGloves' alpha encoding, at a serial port (USB, or
// Bluetooth's rfcomm).

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

#include "spec/glove_options.hpp"
#include "stream/stream_glove.hpp"

namespace nendo::driver::lucidgloves {

/// The table's entry for `lucidgloves:PATH?baud=N&range=4095|1023&hand=left|right`. The glove
/// streams by itself, so that its lines, and no answer, prove that it is there; boards that restart
/// when their port is opened are waited for. Nothing tells the range of its numbers, hence the
/// option: 1023 for AVR boards. Which slots it has is learnt from its first lines; `side` counts
/// if neither the glove nor `hand` tells the hand. May block for 4 s. Errors: usage, no_device,
/// no_permission.
///
/// Its brakes are set while it streams, and freed at its end; a legacy firmware's are left alone.
/// The switch at the wrist stays unknown: the flag "grab" is no switch but a gesture that the
/// firmware finds in the curls.
Result<std::unique_ptr<Glove>> open_lucidgloves(const GloveSpec& spec, std::optional<Side> side);

/// Does the same for any port, with the range and the settings that the options hold.
Result<std::unique_ptr<Glove>> open_lucidgloves_by(const std::string& source, OpenPort open_port,
                                                   std::uint16_t range, const HandWishes& hands);

} // namespace nendo::driver::lucidgloves
