#pragma once
// `auto`: the glove that this machine knows to be one.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// The table's entry for `auto[:left|right]`. Opens only ports that are identified as gloves, one
/// after the other, until one is the wanted hand.
Result<std::unique_ptr<Glove>> open_auto(const GloveSpec& spec, std::optional<Side> side);

} // namespace nendo::driver
