#pragma once
// Makes a loop over the open hands, which are placed so that they hold the model between them.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gloves/open_hand.hpp"
#include "session/run_options.hpp"

namespace nendo::session {

/// The parameters of which a loop was made, besides its model's file.
struct PlacedSetup {
  std::vector<flow::HandInput> inputs;
  flow::Placement placement;
  flow::LoopOptions options;     ///< with the supports in model units
  Eigen::Index spare_points = 0; ///< max points that a puppet may get during the run

  /// Returns which inputs are layers that live gloves play; bit k is input k.
  std::uint32_t live_layers() const noexcept;
};

struct PlacedLoop {
  std::unique_ptr<flow::DeformLoop> loop;
  PlacedSetup setup;
};

/// The things with which a run begins. All of them outlive its loop.
struct LoopStart {
  const PlacedLoop& placed;
  const deform::Mesh& model;
  const std::vector<gloves::OpenHand>& hands;
};

/// Makes the loop that options.loop describes, with the radii of options.radius, and places
/// the hands at the model, or makes the loop of options.over, with them as layers. Errors: usage
/// (radius, or too many layers), failed (the hands cannot grab the
/// model).
Result<PlacedLoop> place_loop(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                              const deform::Mesh& model);

/// The most that a frame of a loop may hold, whatever its settings become.
struct FrameCapacity {
  std::size_t fields = 0;
  std::size_t functions = 0; ///< functions per field
  std::size_t vectors = 0;   ///< vectors of deform::SurfaceMove
};
FrameCapacity frame_capacity(const PlacedLoop& placed);

/// Returns the supports of both hands' fingertips that --radius asks for, in model units; nothing
/// if the text is empty. Error: usage.
Result<std::optional<deform::Supports>> parse_radius(const std::string& text,
                                                     double units_per_metre);

} // namespace nendo::session
