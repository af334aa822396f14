#pragma once
// Opens a glove from a typed specification, with one grammar everywhere:
//   serial:/dev/ttyUSB0   serial:/dev/ttyUSB0?baud=38400   auto   auto:left
//   serve   serve:NAME?hand=left   sim   sim:pinch?seed=7&rate=100&hand=left&sensors=18
// A program can add kinds of gloves, and motions of simulated ones.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/device_spec.hpp>
#include <nendo/driver/glove.hpp>

namespace nendo::driver {

/// Returns the joint angle of each sensor, by slot, in radians, at `time_s` >= 0 seconds after
/// start(). Flexion is positive; abduction is the angle between neighbouring fingers. The glove's
/// thread calls it; it must not throw.
using SensorMotion = std::function<std::array<double, sensor_slots>(double time_s)>;

/// The options of a `sim:` specification.
struct SimulatedGloveOptions {
  std::string source;            ///< the specification
  std::string motion = "sculpt"; ///< the motion's name, not validated
  std::uint32_t seed = 1;
  double rate_hz = 90.0;
  Side side = Side::right;
  unsigned sensors = 22; ///< or 18
};

/// A motion of simulated gloves, `sim:NAME`, besides motion_names().
struct NamedMotion {
  std::string_view name;
  /// Called at most once, by open_glove(), which returns its error.
  std::function<Result<SensorMotion>(const SimulatedGloveOptions&)> make;
};

struct GloveContext;

/// The driver of a kind of glove.
struct GloveDriver {
  std::string_view kind;    ///< the part before the colon
  std::string_view grammar; ///< the grammar in `--help`
  std::string_view summary; ///< the description in `--help`
  /// Opens and identifies the glove, as open_glove() does.
  Result<std::unique_ptr<Glove>> (*open)(const DeviceSpec& spec, std::optional<Side> side,
                                         const GloveContext& context);
};

/// Drivers and motions that a program adds. The library's names take precedence.
struct GloveContext {
  std::vector<GloveDriver> drivers{};
  std::vector<NamedMotion> motions{};
};

/// Opens and identifies the glove; may block for up to 5 seconds. `side` is the requested hand:
/// `auto` opens only gloves of this hand, and a simulated glove gets it (right if nullopt). Errors:
/// usage (kind, option), no_device (missing, or does not answer like a glove), no_permission; those
/// of drivers in `context`.
NENDO_API Result<std::unique_ptr<Glove>> open_glove(std::string_view spec,
                                                    std::optional<Side> side = std::nullopt,
                                                    const GloveContext& context = {});

/// Returns the library's drivers, then the drivers in `context`.
NENDO_API std::vector<GloveDriver> glove_drivers(const GloveContext& context = {});

} // namespace nendo::driver
