#pragma once
// The driver of LucidGloves, and of other gloves with OpenGloves' alpha encoding, at a serial port
// (USB, or Bluetooth's rfcomm).

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/glove_options.hpp>
#include <nendo/driver/open_glove.hpp>

#include "stream/stream_glove.hpp"

namespace nendo::driver::lucidgloves {

/// Opens `lucidgloves:PATH?baud=N&range=4095|1023&hand=left|right`, as the table of drivers wants
/// it. The glove streams by itself, so its lines prove that it is there. Boards that restart when
/// their port is opened are waited for. The range of the numbers is an option (1023 for AVR
/// boards), because the glove does not report it. Larger numbers count as the range and negative
/// ones as 0, with a warning and a fact if the first lines have some. The glove's slots are learnt
/// from its first lines. `side` counts if neither the glove nor `hand` names the hand. May block
/// for 4 s. Errors: usage, no_device, no_permission.
///
/// While the glove streams, each line is answered, because firmwares with force feedback wait for
/// that: by the brakes, once they were set, or else by an empty line. At the end they are freed.
/// A legacy firmware gets only empty lines; its brakes are not used (lucidgloves_parser.hpp). The
/// switch at the wrist stays unknown, because the flag "grab" is not a switch but a gesture that
/// the firmware finds in the curls.
Result<std::unique_ptr<Glove>> open_lucidgloves(const DeviceSpec& spec, std::optional<Side> side);

/// Does the same for any port, with the range and the settings that the options hold.
Result<std::unique_ptr<Glove>> open_lucidgloves_by(const std::string& source, OpenPort open_port,
                                                   std::uint16_t range, const SideOptions& hands);

} // namespace nendo::driver::lucidgloves
