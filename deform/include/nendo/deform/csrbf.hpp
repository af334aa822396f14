#pragma once
// Finds the field that moves start points by given displacements (Sato, Savchenko, Ohbuchi 2004,
// section 2.3): s(c_i) = g_i and sum_i a_i q(c_i) = 0 for every q in p's basis.

#include <optional>
#include <string_view>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <nendo/deform/field.hpp>

namespace nendo::deform {

/// The paper has `linear`. It is global: moving one point moves the whole model, so `none` is the
/// default; Wendland functions need no polynomial to be solvable.
enum class Polynomial { none, constant, linear };

std::string_view name_of(Polynomial polynomial) noexcept;
std::optional<Polynomial> polynomial_named(std::string_view name) noexcept;

struct CsrbfOptions {
  Wendland kernel = Wendland::c2;
  Polynomial polynomial = Polynomial::none;
  /// Start points nearer than this fraction of the radius (the larger of the two) share their
  /// displacements, the more the nearer they are, and wholly when they coincide: a pinch stays
  /// bounded and continuous. From this distance on, interpolation is exact.
  double merge_fraction = 1e-6;
};

enum class FieldStatus {
  ok,
  merged,    ///< some start points shared their displacements
  singular,  ///< these centres and radii have no usable solution; the field is unchanged
  not_finite ///< an input was NaN, infinite or beyond 1e100, a radius not positive; the field is
             ///< unchanged
};
std::string_view describe(FieldStatus status) noexcept;

constexpr bool is_solved(FieldStatus status) noexcept {
  return status == FieldStatus::ok || status == FieldStatus::merged;
}

/// Factorises once for a set of start points, then solves for any number of displacements. After
/// the first build() of a size, neither build() nor solve() of that size allocates, locks or calls
/// the system, up to `lean_size` points.
class CsrbfSolver {
public:
  static constexpr Eigen::Index lean_size = 32;

  explicit CsrbfSolver(CsrbfOptions options) : options_(options) {}

  /// Allocates for this many points, so that already the first build() need not.
  void reserve(Eigen::Index points);
  /// Assembles and factorises: Cholesky of A and the Schur complement of the polynomial part where
  /// all radii are equal, LU with a condition check where they are not (A is then unsymmetric and
  /// singular for some poses). starts: 3 by n; radii: n, all > 0.
  FieldStatus build(const Points& starts, const Eigen::VectorXd& radii);
  /// displacements: 3 by n, g_i. Writes the whole field. Needs a successful build().
  FieldStatus solve(const Points& displacements, CsrbfField& field);

private:
  void assemble();
  void orthonormalise(const Eigen::Matrix4d& normalise);
  void merge_near();
  bool factorise_symmetric();
  bool factorise_general();
  void solve_in_place(Eigen::MatrixX3d& values);
  FieldStatus status_if_solved() const { return merged_ ? FieldStatus::merged : FieldStatus::ok; }

  CsrbfOptions options_;
  Points starts_;
  Eigen::VectorXd radii_;
  bool symmetric_ = true; ///< all radii are equal
  bool merged_ = false;
  bool usable_ = false;
  Eigen::MatrixXd saddle_;               ///< [A Q; Q^T U]
  Eigen::Matrix4d world_to_basis_;       ///< q(x) from (1, x, y, z)
  Eigen::LLT<Eigen::MatrixXd> cholesky_; ///< of A
  Eigen::MatrixX4d solved_basis_;        ///< A^-1 Q
  Eigen::LLT<Eigen::Matrix4d> schur_;    ///< of Q^T A^-1 Q + U
  Eigen::FullPivLU<Eigen::MatrixXd>
      elimination_; ///< of the saddle-point matrix where A is unsymmetric
  Eigen::MatrixX3d right_side_, solution_, correction_, scratch_;
};

} // namespace nendo::deform
