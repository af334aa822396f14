#pragma once
// The driver of the Essential Reality P5, which has five bend sensors. Its button A is the wrist
// switch.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

#include "transport/usb_transport.hpp"

namespace nendo::driver::p5 {

/// Opens the P5 that `wanted` names, by `deadline`. Options: `hand` (left or right), because a P5
/// does not say; it was sold for the right hand. While it streams it does not move the mouse.
/// Errors: usage (option), those of open_usb(), no_device (it sends nothing).
Result<std::unique_ptr<Glove>> open_p5(const GloveSpec& spec, const UsbWanted& wanted,
                                       HostTime deadline);

} // namespace nendo::driver::p5
