#pragma once
// The radial functions of which a field is made. They have one radius, several radii that all start
// points share, or radii that a start point has for itself (the paper's third open problem).
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

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// The function psi(|x - c| / radius). Where several functions reach, those with the greater
/// weights take the greater part of the field.
struct Support {
  double radius = 1.0; ///< > 0
  double weight = 1.0; ///< > 0; only ratios of weights matter

  friend bool operator==(const Support&, const Support&) = default;
};

/// A function that one start point has for itself.
struct OwnSupport {
  Eigen::Index point = 0; ///< the column of that start point
  Support support;

  friend bool operator==(const OwnSupport&, const OwnSupport&) = default;
};

struct NENDO_API Supports {
  /// At least one. Every start point has the kernel sum_s w_s psi(d / r_s), with one coefficient.
  std::vector<Support> shared;
  /// Functions with coefficients of their own. Of all fields that interpolate the control vectors,
  /// the solver takes the one with the least energy: the sum of |a_e|^2 / w_e plus the energy of
  /// the shared part. A small shared weight leaves most of the field to the own functions.
  std::vector<OwnSupport> own;

  /// Returns how many functions the field of so many start points has.
  Eigen::Index functions(Eigen::Index points) const noexcept;
  /// Returns whether all radii and weights are finite, at most 1e100, and > 0.
  bool are_usable() const noexcept;
};

/// Returns whether all of the box is within the largest radius of each of these start points, so
/// that nothing in it stays where it is. False if the box or the list is empty, or the box is one
/// point.
NENDO_API bool reach_all_of(const Box& box, const Points& starts, const Supports& supports);

/// Returns the least and the largest radius of all functions.
NENDO_API double min_radius(const Supports& supports) noexcept;
NENDO_API double largest_radius(const Supports& supports) noexcept;

/// Returns one shared function with this radius in model units, > 0.
inline Supports one_radius(double radius) {
  return {{Support{radius}}, {}};
}

inline constexpr double default_common_weight = 0.01;

/// Returns supports in which start points have the radii of `own`, at least one, beside a common
/// radius that all share. Without `common`, the common radius is the least of them, with
/// default_common_weight, so that no finger reaches farther than its radius. Where all radii
/// are equal, the result is that one radius, since the field would be the same.
NENDO_API Supports with_common(std::vector<OwnSupport> own, std::optional<Support> common = {});
/// Writes the same for one radius per start point. Does not allocate if `out` held as many before.
/// An empty list gives one radius of 1.
NENDO_API void assign_radii(Supports& out, const Eigen::VectorXd& radii);

/// Parses a radius like `10`, or several with weights like `10+40:0.5`: "+" separates supports,
/// and ":" precedes a weight. Returns nullopt if the text has another form, or if a number is not
/// finite, above 1e100, or not > 0.
NENDO_API std::optional<std::vector<Support>> parse_supports(std::string_view text);
/// Parses one such text that all start points share, or several strings with commas between them,
/// which are the fingers' own supports beside a common radius. The number of strings must divide
/// `points`; they repeat, so that five strings for the ten fingertips of two hands make both hands
/// alike. Returns nullopt if the text has another form.
NENDO_API std::optional<Supports> parse_supports_by_point(std::string_view text,
                                                          Eigen::Index points);

} // namespace nendo::deform
