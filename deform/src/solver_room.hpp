#pragma once
// What a tick must not allocate.

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// A field of zeros with room for all functions that these supports make of so many start points.
CsrbfField room_for_field(const Supports& supports, Eigen::Index points, Wendland kernel);

/// Up to CsrbfSolver::lean_size points, no later build() or solve() of this size allocates.
void make_room(CsrbfSolver& solver, const Supports& supports, Eigen::Index points);

/// The same with radii as float holds them, so that the matrix and the evaluation agree.
Supports rounded(Supports supports, const BlockLayout& layout);

/// The least radius of the functions whose centre each point is.
Eigen::VectorXd least_radii(const Supports& supports, Eigen::Index points);

} // namespace nendo::deform
