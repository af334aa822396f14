#pragma once
// A simulated glove. It sends what a typical wearer's glove would, in 8-bit counts, with noise. Its
// motion is one of those of motion_names(), or comes from the caller.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// Returns the names of the motions that a simulated or emulated hand can make by itself: rest,
/// wave, pinch, grasp, sculpt.
std::vector<std::string_view> motion_names();

/// `sim:MOTION?seed=N&rate=HZ&hand=left|right&sensors=18|22`; all of it may be left out; a hand
/// that is not named is `side`, or right. Error: usage, naming the option and what is allowed.
Result<SimulatedGloveOptions> simulated_glove_options(const GloveSpec& spec,
                                                      std::optional<Side> side);

/// Samples come at absolute deadlines from start() on; one that is missed is skipped, the grid
/// stays.
std::unique_ptr<Glove> make_simulated_glove(const SimulatedGloveOptions& options,
                                            SensorMotion motion);

} // namespace nendo::driver
