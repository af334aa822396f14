#pragma once
// `usb:VID:PID`: gloves that are USB devices of their own, known by vendor and product number. A
// table of its own says which driver has which vendor's gloves.

#include <memory>
#include <optional>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// Opens `usb:VID:PID[?serial=TEXT&hand=left|right]`. `side` is not used: the glove, or the option,
/// says which hand it is. Blocks and fails as open_glove().
Result<std::unique_ptr<Glove>> open_usb_glove(const GloveSpec& spec, std::optional<Side> side);
/// Does the same, and gives up at `deadline`.
Result<std::unique_ptr<Glove>> open_usb_glove_by(const GloveSpec& spec, HostTime deadline);

} // namespace nendo::driver
