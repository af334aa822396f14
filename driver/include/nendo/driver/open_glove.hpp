#pragma once
// From what a user types to an open glove. One grammar everywhere:
//   serial:/dev/ttyUSB0   serial:/dev/ttyUSB0?baud=38400   auto   auto:left
//   sim   sim:pinch?seed=7&rate=100&hand=left&sensors=18   replay:take1.nendo?speed=0.5

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>

namespace nendo::driver {

/// `kind:target?key=value&key=value`, taken apart but not yet judged.
struct GloveSpec {
  std::string text; ///< as typed
  std::string kind;
  std::string target; ///< may be empty
  std::map<std::string, std::string> options;
};

/// Error: usage, naming what cannot be read in it.
Result<GloveSpec> parse_glove_spec(std::string_view text);

/// Opens and identifies the glove; may block, 5 seconds at most. `side` is the hand that the user
/// wants it for: `auto` opens no other, and a simulated hand is that one (right if any will do).
/// Errors: usage (kind, option), no_device (missing, or does not answer like a glove),
/// no_permission.
Result<std::unique_ptr<Glove>> open_glove(std::string_view spec,
                                          std::optional<Side> side = std::nullopt);

/// A line a kind of glove, for `--help`: its grammar and what it is.
struct DriverSummary {
  std::string_view grammar;
  std::string_view summary;
};
std::vector<DriverSummary> driver_summaries();

} // namespace nendo::driver
