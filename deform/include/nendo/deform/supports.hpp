#pragma once
// Of which radial functions a field may be made: of one radius, of several that all start points
// share, or of some that each start point has for itself (the paper's third open problem).
//
// The equations' matrix is M = sum_s w_s A_s + Psi W Psi^T, with A_s the start points' Wendland
// matrix of the shared radius s, Psi the own functions at the start points, W their weights. Why M
// is positive definite for every choice of radii and weights > 0:
//  1. each A_s is positive definite (Wendland 1995), and so is their sum, for there is one;
//  2. x^T Psi W Psi^T x = |W^(1/2) Psi^T x|^2 is never negative;
//  3. so x^T M x > 0 for x != 0.
// A radius for each column instead, and no shared one, gives a matrix that is singular on the way
// between ordinary poses.

#include <optional>
#include <string_view>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// psi(|x - c| / radius). Where functions compete, the greater weight takes more of the field.
struct Support {
  double radius = 1.0; ///< > 0
  double weight = 1.0; ///< > 0; only ratios of weights matter

  friend bool operator==(const Support&, const Support&) = default;
};

struct OwnSupport {
  Eigen::Index point = 0; ///< whose start point is its centre
  Support support;

  friend bool operator==(const OwnSupport&, const OwnSupport&) = default;
};

struct Supports {
  /// At every start point, with one coefficient: the kernel sum_s w_s psi(d / r_s). At least one.
  std::vector<Support> shared;
  /// Functions with coefficients of their own. Of all fields through the control vectors, the one
  /// with the least sum of |a_e|^2 / w_e plus the shared part's energy is taken: a small shared
  /// weight leaves the field to them as far as they can carry it.
  std::vector<OwnSupport> own;

  /// How many functions the solved field has.
  Eigen::Index functions(Eigen::Index points) const noexcept;
  /// Whether radii and weights are finite, at most 1e100, and > 0.
  bool are_usable() const noexcept;
};

inline Supports one_radius(double radius) {
  return {{Support{radius}}, {}};
}

inline constexpr double default_common_weight = 0.01;

/// Every start point its own radii beside a common one. Without `common` that is the least of them,
/// so that no finger reaches farther than it was told, with default_common_weight. Where all radii
/// are one and the same, the field would be that of this radius alone, and so that is returned.
/// own: at least one.
Supports with_common(std::vector<OwnSupport> own, std::optional<Support> common = {});
/// The same, a radius each, without allocation if `out` held as many before.
void assign_radii(Supports& out, const Eigen::VectorXd& radii);

/// `10`, or radii with weights like `10+40:0.5`: "+" between supports, ":" before a weight. Nothing
/// if it is not that, or a number is not finite, above 1e100 or not > 0.
std::optional<std::vector<Support>> parse_supports(std::string_view text);
/// One such text for all start points, which then share it, or several with commas between: each
/// finger's own, beside a common radius. Their number divides that of the points, and they repeat:
/// five for the ten fingertips of two hands make both hands alike. Nothing if it is not that.
std::optional<Supports> parse_supports_by_point(std::string_view text, Eigen::Index points);

} // namespace nendo::deform
