#pragma once
// The BeBop Forte Data Glove at a serial port, by USB or Bluetooth.

#include <memory>
#include <optional>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver::forte {

/// Opens `forte:PATH?link=usb|bluetooth&baud=460800|115200&hand=left|right`, as the table of
/// drivers wants it. The glove is told to send over `link`, and recognised by its records. `hand`,
/// or else `side`, tells the hand. Each finger has two sensors, in the slots of its MCP and PIP
/// joints (the thumb's MCP and IP). May block for 4 s. Errors: usage, no_device, no_permission.
Result<std::unique_ptr<Glove>> open_forte(const GloveSpec& spec, std::optional<Side> side);

} // namespace nendo::driver::forte
