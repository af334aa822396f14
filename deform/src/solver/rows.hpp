#pragma once
// The type of the values that the parts of the solver exchange.

#include <Eigen/Core>

namespace nendo::deform {

/// A row for each start point, with three coordinates and an unused number, or with the four terms
/// of the polynomial. A row fills two SSE registers or one of AVX.
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

} // namespace nendo::deform
