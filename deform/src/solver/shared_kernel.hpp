#pragma once
// The kernel sum_s w_s psi(d / r_s) that all start points share, and the ties between those that
// are near each other.

#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

/// Returns the square of a distance, or a little more because of rounding. It serves to compare
/// squared distances before their roots are taken.
constexpr double squared_or_more(double distance) noexcept {
  return distance * distance * (1.0 + 1e-12);
}

class SharedKernel {
public:
  SharedKernel(Wendland kernel, const Supports& supports) noexcept
      : kernel_(kernel), first_(supports.shared.front()), supports_(&supports.shared) {
    for (const Support& support : supports.shared)
      reach_ = support.radius > reach_ ? support.radius : reach_;
  }

  double at(double distance) const noexcept {
    double sum = first_.weight * wendland(kernel_, distance / first_.radius);
    for (std::size_t s = 1; s < supports_->size(); ++s) {
      const Support& support = (*supports_)[s];
      sum += support.weight * wendland(kernel_, distance / support.radius);
    }
    return sum;
  }
  /// Returns the distance from which on the kernel is 0.
  double reach() const noexcept { return reach_; }

private:
  Wendland kernel_;
  Support first_;
  const std::vector<Support>* supports_;
  double reach_ = 0.0;
};

/// Ties the coefficients of near start points together: row i of the equations becomes
///   s(c_i) + w (a_i - a_j) = g_i,
/// with w from 0 at the merge distance to the matrix's own size where c_i and c_j coincide. Two
/// such points thus get the mean displacement, the other points keep their equations, and the
/// matrix stays regular. Smoothing the displacements instead would not be enough: two equal values
/// at vanishing distance demand a zero slope along their connection, which turns with it, and the
/// field would jump.
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
