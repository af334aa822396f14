#pragma once
// What a puppet, masks and symmetry mean for the points that hold the model. A rig may be null: no
// puppet.

#include <memory>
#include <optional>

#include <nendo/base/result.hpp>
#include <nendo/deform/surface_field.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// Returns whether hands play that puppet, which may be null. Otherwise fingertips touch the model.
NENDO_API bool is_played(const puppet::Rig* rig) noexcept;
/// Returns the number of control points that hands move with that puppet; null: without one.
NENDO_API Eigen::Index control_points_of(const puppet::Rig* rig, const SculptorOptions& sculptor,
                                         Eigen::Index hands) noexcept;
/// Returns how many points have radii of their own: the puppet's, or fingertips and their images,
/// even if other points of the hands hold the model.
NENDO_API Eigen::Index supported_points(const puppet::Rig* rig, Eigen::Index hands) noexcept;
/// Returns the x of the plane, in model units, on both sides of which the fingertips shape;
/// nothing: of none.
NENDO_API std::optional<double> mirror_of(const puppet::Rig* rig) noexcept;
/// Returns whether a tick can solve for that puppet's points without allocating. Error, bad_input:
/// there are more than deform::CsrbfSolver::lean_size. Where distances go along the surface, any
/// number is good, because their field is solved for beforehand.
NENDO_API Result<void> check_points(const puppet::Rig* rig);
/// Puts the puppet's masks on that model, and whether it mirrors, into the options. Allocates.
NENDO_API void set_masks(const puppet::Rig* rig, const deform::Mesh& model,
                         const deform::BlockLayout& layout, SculptorOptions& sculptor);
/// Returns the field of a puppet along that model's surface, with the kernel and the radii of these
/// options; null if it measures distances through the air, or no hand plays it. Error: as
/// SurfaceField::make(). Allocates.
NENDO_API Result<std::shared_ptr<const deform::SurfaceField>>
surface_for(const puppet::Rig& rig, const deform::Mesh& model, const deform::BlockLayout& layout,
            const deform::DeformerOptions& options);

} // namespace nendo::flow
