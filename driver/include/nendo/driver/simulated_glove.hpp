#pragma once
// A simulated glove, which sends noisy 8-bit counts like a typical wearer's glove. Its motion is
// one of motion_names(), or comes from the caller.

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// Returns the names of the built-in motions of simulated and emulated hands: rest, wave, pinch,
/// grasp, sculpt, table, faces.
NENDO_API std::vector<std::string_view> motion_names();

/// Parses `sim:MOTION?seed=N&rate=HZ&hand=left|right&sensors=18|22`; the motion and all options are
/// optional. The default for `hand` is `side`, or else right. Error: usage, naming the option and
/// the allowed values.
NENDO_API Result<SimulatedGloveOptions> simulated_glove_options(const DeviceSpec& spec,
                                                                std::optional<Side> side);

/// Makes a glove with the given motion. Sample n comes n periods after start(); missed deadlines
/// are skipped.
NENDO_API std::unique_ptr<Glove> make_simulated_glove(const SimulatedGloveOptions& options,
                                                      SensorMotion motion);

} // namespace nendo::driver
