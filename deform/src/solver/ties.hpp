#pragma once
// Ties the coefficients of near start points together: row i of the equations becomes
//   s(c_i) + w (a_i - a_j) = g_i,
// with w from 0 at the merge distance to the matrix's own size where c_i and c_j coincide. Two such
// points thus get the mean displacement, the other points keep their equations, and the matrix
// stays regular. Smoothing the displacements instead would not be enough: two equal values at
// vanishing distance demand a zero slope along their connection, which turns with it, and the field
// would jump.

#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

class Ties {
public:
  Ties(const CsrbfOptions& options, const Supports& supports) noexcept;

  /// Returns the distance beyond which nothing is tied.
  double reach() const noexcept { return reach_; }
  /// Returns w at this distance. own_size is half the sum of the two diagonal entries of the own
  /// functions' part of M; own_resistance is own_size less the entry beside the diagonal.
  double strength(double distance, double own_size, double own_resistance) const noexcept;

private:
  double reach_;
  double size_;       ///< the shared part's diagonal entries
  double resistance_; ///< the shared part's, to a difference of a_i and a_j at the merge distance
};

} // namespace nendo::deform
