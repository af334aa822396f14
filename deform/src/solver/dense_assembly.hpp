#pragma once
// Assembles M with its ties as a whole matrix.

#include "solver/own_functions.hpp"
#include "solver/ties.hpp"

namespace nendo::deform {

/// Writes the lower triangle of `lower`, n by n. `diagonal` has n entries and is scratch room.
/// Returns whether points were tied. Does not allocate.
bool assemble_dense(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                    const OwnFunctions& own, Eigen::MatrixXd& lower, Eigen::VectorXd& diagonal);

} // namespace nendo::deform
