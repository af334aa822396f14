#pragma once
// The equations of fields that keep the volume: three rows per start point, and one right side.

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/volume_kernel.hpp>

#include "solver/own_functions.hpp"

namespace nendo::deform {

/// Returns the matrix that a function with this support has at an offset from its centre.
Eigen::Matrix3d volume_matrix(const CsrbfOptions& options, double radius,
                              const Eigen::Vector3d& offset) noexcept;

/// Writes the lower triangle of M, 3n by 3n: sum_s w_s A_s + Psi W Psi^T (supports.hpp) with a
/// matrix for each number, and ties. Returns whether points were tied. Does not allocate.
bool assemble_volume(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                     Eigen::MatrixXd& lower);

/// Returns the coefficient of an own function, from the solution a: three rows per start point, of
/// which the first column counts.
Eigen::Vector3d own_volume_coefficient(const CsrbfOptions& options, const Points& starts,
                                       const OwnSupport& own, const Rows& a) noexcept;

} // namespace nendo::deform
