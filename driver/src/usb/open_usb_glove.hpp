#pragma once
// `usb:VID:PID`: gloves that are USB devices of their own, known by vendor and product number.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

#include "stream/stream_glove.hpp"
#include "transport/usb_transport.hpp"

namespace nendo::driver {

/// The table's entry for `usb:VID:PID[?serial=TEXT&hand=left|right]`. `side` is not needed: the
/// glove, or the option, says which hand it is.
Result<std::unique_ptr<Glove>> open_usb_glove(const GloveSpec& spec, std::optional<Side> side);
/// The same, done by `deadline`.
Result<std::unique_ptr<Glove>> open_usb_glove_by(const GloveSpec& spec, HostTime deadline);

/// Opens what is `wanted`, and after that the same device wherever it turns up: by its serial
/// number, or by its port if it has none.
OpenPort usb_opener(UsbWanted wanted, const UsbInterface& interface);

/// What the kernel knows of the device.
std::vector<GloveFact> facts_of(const UsbIdentity& identity);

} // namespace nendo::driver
