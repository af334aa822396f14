#pragma once
// Allocates ahead what a tick must not allocate.

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// Returns a field of zeros with room for all functions that these supports make of so many start
/// points.
CsrbfField room_for_field(const Supports& supports, Eigen::Index points, Wendland kernel);

/// Makes room in the solver, so that no later build() or solve() of this size allocates, up to
/// CsrbfSolver::lean_size points.
void make_room(CsrbfSolver& solver, const Supports& supports, Eigen::Index points);

/// Returns the supports with radii as float holds them, so that the matrix and the evaluation
/// agree.
Supports rounded(Supports supports, const BlockLayout& layout);

/// Returns, for each point, the least radius of the functions that have it as their centre.
Eigen::VectorXd min_radii(const Supports& supports, Eigen::Index points);

/// Returns whether strokes keep the volume, in midpoint steps.
inline bool keeps_volume(const DeformerOptions& options) noexcept {
  return options.csrbf.keep_volume > 0.0;
}

} // namespace nendo::deform
