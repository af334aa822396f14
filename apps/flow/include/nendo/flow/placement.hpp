#pragma once
// Initial placement. Gloves measure no position in space, so the model is scaled to a size that two
// hands can hold, and a hand is placed at each side of it, with fingertips on the surface.

#include <array>
#include <optional>

#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::flow {

/// The fingertips of a hand, 3 by 5, thumb to little finger, in metres.
using Fingertips = Eigen::Matrix<double, 3, 5>;

struct PlacementOptions {
  double model_size_m = 0.8;    ///< the longest side of the model's bounding box, on the stage
  double height_fraction = 0.7; ///< the fingertips' height, relative to the model's
};

/// The table on which clay lies: a square plate, in model units.
struct Table {
  Eigen::Vector3d top = Eigen::Vector3d::Zero(); ///< the centre of its upper side
  double half_side = 0.0;
};

/// The stage has the model's axes, in metres: x to the operator's right, y up, z towards the
/// operator, and its origin is that of the vertices (deform::Mesh::offset). Models have y up.
struct Placement {
  double units_per_metre = 1.0; ///< model units per metre of the stage
  std::array<Eigen::Isometry3d, 2> T_stage_wrist{Eigen::Isometry3d::Identity(),
                                                 Eigen::Isometry3d::Identity()};
  std::optional<Table> table; ///< nothing: table_under() the loop's initial model

  static constexpr std::size_t index_of(Side side) noexcept { return side == Side::left ? 0 : 1; }
};

/// Places the hands at the model. tips_wrist: each hand's fingertips in its wrist's frame, in the
/// pose that touches the model; nullopt: no such hand. Registers the five tips rigidly to the
/// surface (point to plane), starting from hands at both sides, palms inwards, fingers forward,
/// thumbs up. Allocates; not for the loop.
NENDO_API Placement place_hands(const deform::Mesh& model,
                                const std::array<std::optional<Fingertips>, 2>& tips_wrist,
                                const PlacementOptions& options = {});

/// Places the hands of a puppet's player in front of the model, at both sides, without a search:
/// backs towards the viewer, fingers up and slightly forward.
NENDO_API Placement place_player(const deform::Mesh& model, double model_size_m = 0.46);

/// Returns where hands are that have no model between them: beside each other, 30 cm apart, palms
/// down and fingers forward. The stage's unit is the metre.
NENDO_API Placement place_without_model() noexcept;

/// Returns a table at the height of the model's lowest vertex, much wider than the model.
NENDO_API Table table_under(const deform::Mesh& model, double units_per_metre) noexcept;

} // namespace nendo::flow
