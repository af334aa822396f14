#pragma once
// The motions by which simulated gloves do something to the model before them.

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/wrist.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::motions {

struct PlannedHand {
  const deform::Mesh& model;
  double model_size_m = 0.8; ///< its longest side, on the stage
  std::optional<Side> side;  ///< nothing: the hand that the specification names
  hand::HandSize size{};
  // Set by the opening, because a real glove would not know it:
  std::optional<Eigen::Isometry3d> T_stage_wrist{};    ///< where it begins
  std::shared_ptr<const flow::WristPath> wrist_path{}; ///< null: it stays there
};

/// Returns the motions for driver::GloveContext: `touch`, whose hand touches the model, and those
/// of KneadTask. To make one takes about 0.2 s, sets what the opening sets in `hand`, and says on
/// standard error which fingers cannot reach the model. `hand` must outlive that; with null, there
/// is no model. Errors: usage (no model), bad_input (nothing can be done to the model).
std::vector<driver::NamedMotion> planned_motions(PlannedHand* hand);

} // namespace nendo::motions
