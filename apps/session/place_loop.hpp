#pragma once
// Places the hands at the model, and makes the loop.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gloves/open_hand.hpp"
#include "session/run_options.hpp"

namespace nendo::session {

/// The parameters of a loop, except its model's file.
struct PlacedSetup {
  std::vector<flow::HandInput> inputs;
  flow::Placement placement;
  flow::LoopOptions options;     ///< with the supports in model units
  Eigen::Index spare_points = 0; ///< max additional points of a puppet during the run

  /// Returns the inputs that are layers of live gloves; bit k is input k.
  std::uint32_t live_layers() const noexcept;
};

struct PlacedLoop {
  std::unique_ptr<flow::DeformLoop> loop;
  PlacedSetup setup;
};

/// The initial state of a run. All members outlive the loop.
struct LoopStart {
  const PlacedLoop& placed;
  const deform::Mesh& model;
  const std::vector<gloves::OpenHand>& hands;
};

/// Makes the loop of options.loop, with the radii of options.radius, and places the hands at the
/// model; or makes the loop of options.over, with the hands as layers. Errors: usage (radius, or
/// too many layers), failed (the hands cannot grab the model).
Result<PlacedLoop> place_loop(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                              const deform::Mesh& model);

/// Returns the max contents of the frames of that loop.
flow::FrameCapacity frame_capacity(const PlacedLoop& placed);

/// Parses --radius. Returns the supports of both hands' fingertips, in model units; nothing if the
/// text is empty. Error: usage.
Result<std::optional<deform::Supports>> parse_radius(const std::string& text,
                                                     double units_per_metre);

} // namespace nendo::session
