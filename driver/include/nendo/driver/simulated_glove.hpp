#pragma once
// A simulated glove whose motion comes from elsewhere: for hands that know what this folder does
// not, such as a surface that they touch. What it sends is what a typical wearer's glove would, in
// 8-bit counts, with noise.

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

/// The joint angle of each sensor, by slot, in radians, at a time since start() in seconds, at
/// least 0. Flexion is positive, abduction the angle between neighbours. The glove's thread calls
/// it; it must not throw.
using SensorMotion = std::function<std::array<double, sensor_slots>(double time_s)>;

/// Returns the names of the motions that a simulated or emulated hand can make by itself: rest,
/// wave, pinch, grasp, sculpt.
std::vector<std::string_view> motion_names();

/// The one motion of `sim` that open_glove() cannot open, because it takes a surface.
inline constexpr std::string_view touching_motion = "touch";

/// What a `sim:` specification asks for.
struct SimulatedGloveOptions {
  std::string source;            ///< the specification
  std::string motion = "sculpt"; ///< its name, not yet judged
  std::uint32_t seed = 1;
  double rate_hz = 90.0;
  Side side = Side::right;
  unsigned sensors = 22; ///< or 18
};

/// `sim:MOTION?seed=N&rate=HZ&hand=left|right&sensors=18|22`; all of it may be left out; a hand
/// that is not named is `side`, or right. Error: usage, naming the option and what is allowed.
Result<SimulatedGloveOptions> simulated_glove_options(const GloveSpec& spec,
                                                      std::optional<Side> side);

/// Samples come at absolute deadlines from start() on; one that is missed is skipped, the grid
/// stays.
std::unique_ptr<Glove> make_simulated_glove(const SimulatedGloveOptions& options,
                                            SensorMotion motion);

} // namespace nendo::driver
