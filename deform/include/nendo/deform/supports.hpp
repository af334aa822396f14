#pragma once
// The radial functions of a field. They have one radius, several radii that all start points share,
// or radii of single start points (the paper's third open problem).
//
// The equations' matrix is M = sum_s w_s A_s + Psi W Psi^T, with A_s the start points' Wendland
// matrix of the shared radius s, Psi the own functions at the start points, W their weights. Why M
// is positive definite for every choice of radii and weights > 0:
//  1. each A_s is positive definite (Wendland 1995), and so is their sum, which has at least one
//     term;
//  2. x^T Psi W Psi^T x = |W^(1/2) Psi^T x|^2 is never negative;
//  3. so x^T M x > 0 for x != 0.
// With one radius per column, and no shared radius, the matrix becomes singular between ordinary
// poses.

#include <optional>
#include <string_view>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// The function psi(|x - c| / radius). Where several functions overlap, those with greater weights
/// get a greater share of the field.
struct Support {
  double radius = 1.0; ///< > 0
  double weight = 1.0; ///< > 0; only ratios of weights matter

  friend bool operator==(const Support&, const Support&) = default;
};

/// A function of a single start point.
struct OwnSupport {
  Eigen::Index point = 0; ///< column index of the start point
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

  /// Returns the number of functions of a field with this number of start points.
  Eigen::Index functions(Eigen::Index points) const noexcept;
  /// Returns whether all radii and weights are finite, at most 1e100, and > 0.
  bool are_usable() const noexcept;
};

/// Returns whether the whole box is within the largest radius of each start point, so that the
/// field moves everything in it. False if the box or the list is empty, or the box is one point.
NENDO_API bool reach_all_of(const Box& box, const Points& starts, const Supports& supports);

/// Return the min and the max radius of all functions.
NENDO_API double min_radius(const Supports& supports) noexcept;
NENDO_API double max_radius(const Supports& supports) noexcept;

/// Returns one shared function with this radius in model units, > 0.
inline Supports one_radius(double radius) {
  return {{Support{radius}}, {}};
}

inline constexpr double default_common_weight = 0.01;

/// Returns supports with the radii of `own`, at least one, and a common radius that all start
/// points share. Without `common`, the common radius is the smallest of `own`, with
/// default_common_weight, so that no finger reaches farther than its radius. If all radii are
/// equal, the result is this one radius, because the field would be the same.
NENDO_API Supports with_common(std::vector<OwnSupport> own, std::optional<Support> common = {});
/// Does the same for one radius per start point. Does not allocate if `out` has the same size
/// already. An empty list gives one radius of 1.
NENDO_API void assign_radii(Supports& out, const Eigen::VectorXd& radii);

/// Parses a radius like `10`, or several with weights like `10+40:0.5`: "+" separates supports,
/// and ":" precedes a weight. Returns nullopt if the text has another form, or if a number is not
/// finite, above 1e100, or not > 0.
NENDO_API std::optional<std::vector<Support>> parse_supports(std::string_view text);
/// Parses one such text for all start points, or a comma-separated list, which has the fingers' own
/// supports beside a common radius. The number of entries must divide `points`; they repeat, so
/// that five entries for ten fingertips give both hands the same supports. Returns nullopt if the
/// text has another form.
NENDO_API std::optional<Supports> parse_supports_by_point(std::string_view text,
                                                          Eigen::Index points);

} // namespace nendo::deform
