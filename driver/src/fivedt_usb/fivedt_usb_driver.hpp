#pragma once
// The 5DT Data Glove Ultra with 5 or 14 sensors, by cable or wireless.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

#include "transport/usb_transport.hpp"

namespace nendo::driver::fivedt_usb {

/// Opens the glove that `wanted` names, by `deadline`; its product number says which it is. Errors:
/// usage (option), those of open_usb(), no_device (it sends nothing).
Result<std::unique_ptr<Glove>> open_fivedt_usb(const GloveSpec& spec, const UsbWanted& wanted,
                                               HostTime deadline);

} // namespace nendo::driver::fivedt_usb
