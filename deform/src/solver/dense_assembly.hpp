#pragma once
// M with its ties as a whole matrix.

#include "solver/own_functions.hpp"
#include "solver/ties.hpp"

namespace nendo::deform {

/// Writes the lower triangle of `lower`, n by n; diagonal: n, for scratch. Says whether points were
/// tied. No allocation.
bool assemble_dense(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                    const OwnFunctions& own, Eigen::MatrixXd& lower, Eigen::VectorXd& diagonal);

} // namespace nendo::deform
