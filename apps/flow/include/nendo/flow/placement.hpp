#pragma once
// Places the hands. A glove measures no position in space. So the model is put on a stage
// and scaled to a size that two hands can hold. A hand is placed at each side of it, with the
// fingertips on the surface.

#include <array>
#include <optional>

#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::flow {

/// The tips of a hand's fingers, 3 by 5, thumb to little finger, in metres.
using Fingertips = Eigen::Matrix<double, 3, 5>;

struct PlacementOptions {
  double model_size_m = 0.8;    ///< the longest side of the model's bounding box, on the stage
  double height_fraction = 0.7; ///< where the fingertips touch, relative to the model's height
};

/// The table on which clay lies: a square plate, in model units.
struct Table {
  Eigen::Vector3d top = Eigen::Vector3d::Zero(); ///< the middle of its upper side
  double half_side = 0.0;
};

/// The stage has the model's axes, in metres: x to the operator's right, y up, z towards the
/// operator, and its origin is where vertices count from (deform::Mesh::offset). Models have y up.
struct Placement {
  double units_per_metre = 1.0; ///< model units per metre of the stage
  std::array<Eigen::Isometry3d, 2> T_stage_wrist{Eigen::Isometry3d::Identity(),
                                                 Eigen::Isometry3d::Identity()};
  std::optional<Table> table; ///< nothing: table_under() the model with which a loop begins

  static constexpr std::size_t index_of(Side side) noexcept { return side == Side::left ? 0 : 1; }
};

/// Places the hands at the model. tips_wrist: each hand's fingertips in its wrist's frame, in the
/// pose in which it is to touch the model; an absent hand is nullopt. The five tips are registered
/// rigidly to the surface (point to plane). The search starts from hands that hold the model
/// between them, palms inwards, fingers forward, thumbs up. Allocates; not for the loop.
NENDO_API Placement place_hands(const deform::Mesh& model,
                                const std::array<std::optional<Fingertips>, 2>& tips_wrist,
                                const PlacementOptions& options = {});

/// Places the hands of a puppet's player before the model and beside it, as the player sees them:
/// backs towards the viewer, fingers up and a little forward. No search is performed.
NENDO_API Placement place_player(const deform::Mesh& model, double model_size_m = 0.46);

/// Returns a table as high as the lowest vertex of the model, which reaches far beyond it.
NENDO_API Table table_under(const deform::Mesh& model, double units_per_metre) noexcept;

} // namespace nendo::flow
