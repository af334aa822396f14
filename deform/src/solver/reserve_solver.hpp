#pragma once
// What a deformer makes of its supports before the first tick, which must not allocate.

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// Returns a field of zeros with all functions that these supports make of `points` start points.
CsrbfField zero_field(const Supports& supports, Eigen::Index points, Wendland kernel);

/// Allocates in the solver, so that no later build() or solve() of this size allocates, up to
/// CsrbfSolver::lean_size points.
void reserve_solver(CsrbfSolver& solver, const Supports& supports, Eigen::Index points);

/// Returns the supports with radii as float holds them, so that the matrix and the evaluation
/// agree.
Supports rounded(Supports supports, const BlockLayout& layout);

/// Returns, for each point, the least radius of the functions that have it as their centre.
Eigen::VectorXd min_radii(const Supports& supports, Eigen::Index points);

} // namespace nendo::deform
