#pragma once
// What the pieces of the solver hand each other.

#include <Eigen/Core>

namespace nendo::deform {

/// A row a start point: three coordinates and a spare, or the four terms of the polynomial. A row
/// is two SSE registers, one of AVX.
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

} // namespace nendo::deform
