#pragma once
// `auto`: opens a glove that this machine knows to be one.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// Opens `auto[:left|right]`, as the table of drivers wants it: only ports that are identified as
/// gloves, one after the other, until one is the wanted hand's. Blocks for 5 s at most. Errors:
/// usage, no_device, no_permission.
Result<std::unique_ptr<Glove>> open_auto(const GloveSpec& spec, std::optional<Side> side);

} // namespace nendo::driver
