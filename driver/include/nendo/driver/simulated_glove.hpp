#pragma once
// A simulated glove. It sends what a typical wearer's glove would, in 8-bit counts, with noise. Its
// motion is one of those of motion_names(), or comes from the caller.

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
/// wave, pinch, grasp, sculpt, faces.
NENDO_API std::vector<std::string_view> motion_names();

/// Reads `sim:MOTION?seed=N&rate=HZ&hand=left|right&sensors=18|22`, all of which may be left out.
/// Without `hand` the glove is of `side`, or of the right hand. Error: usage, naming the option and
/// what is allowed.
NENDO_API Result<SimulatedGloveOptions> simulated_glove_options(const GloveSpec& spec,
                                                                std::optional<Side> side);

/// Makes a glove with the given motion. From start() on, sample n comes n periods later; a deadline
/// that was missed is skipped.
NENDO_API std::unique_ptr<Glove> make_simulated_glove(const SimulatedGloveOptions& options,
                                                      SensorMotion motion);

} // namespace nendo::driver
