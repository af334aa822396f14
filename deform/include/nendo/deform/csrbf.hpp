#pragma once
// Finds the field that moves start points by given displacements (Sato, Savchenko, Ohbuchi 2004,
// section 2.3): s(c_i) = g_i and sum_i a_i q(c_i) = 0 for every q in p's basis.

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>

#include <nendo/deform/field.hpp>
#include <nendo/deform/supports.hpp>

namespace nendo::deform {

/// The paper has `linear`. It is global: moving one point moves the whole model, so `none` is the
/// default; Wendland functions need no polynomial to be solvable.
enum class Polynomial { none, constant, linear };

std::string_view name_of(Polynomial polynomial) noexcept;
std::optional<Polynomial> polynomial_named(std::string_view name) noexcept;

struct CsrbfOptions {
  Wendland kernel = Wendland::c2;
  Polynomial polynomial = Polynomial::none;
  /// Start points nearer than this fraction of the least shared radius share their displacements,
  /// the more the nearer they are, and wholly when they coincide: a pinch stays continuous, and
  /// bounded by some 0.25 / merge_fraction displacements, five times that with several radii (as
  /// pinch_test.cpp finds). From this distance on, interpolation is exact.
  double merge_fraction = 1e-6;
};

enum class FieldStatus {
  ok,
  merged,     ///< some start points shared their displacements
  singular,   ///< no usable solution in double; the field is unchanged
  too_dense,  ///< too many start points lie in each other's supports; the field is unchanged
  not_finite, ///< an input was NaN, infinite or beyond 1e100, a radius or weight not positive; the
              ///< field is unchanged
};
std::string_view describe(FieldStatus status) noexcept;

constexpr bool is_solved(FieldStatus status) noexcept {
  return status == FieldStatus::ok || status == FieldStatus::merged;
}

struct SolverChoices; // those of tests and benchmarks: src/solver/solver_choices.hpp

/// What the last build() took. Times are 0 up to lean_size points, where no clock is read.
struct SolverEffort {
  bool sparse = false;
  Eigen::Index matrix_entries = 0; ///< of one triangle
  Eigen::Index factor_entries = 0;
  double order_s = 0.0;    ///< octree
  double assembly_s = 0.0; ///< neighbours, matrix
  double analysis_s = 0.0; ///< minimum degree, the factor's pattern
  double factor_s = 0.0;
};

/// Factorises once for a set of start points, then solves for any number of displacements. Up to
/// `lean_size` points neither build() nor solve() allocates, locks or calls the system once they
/// have been called with as many points, supports and a field of that size.
class CsrbfSolver {
public:
  static constexpr Eigen::Index lean_size = 32;
  /// Beyond this, supports that hold more than an eighth of the start points are too_dense; so is a
  /// factor of more than `most_factor_entries`, which take 800 MB.
  static constexpr Eigen::Index most_dense_points = 4096;
  static constexpr Eigen::Index most_factor_entries = Eigen::Index{1} << 26;
  /// So many pairs of an own function and a start point in its reach; more are too_dense, too.
  static constexpr std::size_t most_own_values = std::size_t{1} << 23;

  explicit CsrbfSolver(CsrbfOptions options);
  ~CsrbfSolver();
  CsrbfSolver(CsrbfSolver&&) noexcept;
  CsrbfSolver& operator=(CsrbfSolver&&) noexcept;

  /// Allocates for this many points with one radius each, so that already the first build() need
  /// not.
  void reserve(Eigen::Index points);
  /// Orders, assembles and factorises: Cholesky of M (supports.hpp), then the Schur complement of
  /// the polynomial part. starts: 3 by n; the supports' points are below n.
  FieldStatus build(const Points& starts, const Supports& supports);
  /// A radius each, n: with_common() of them.
  FieldStatus build(const Points& starts, const Eigen::VectorXd& radii);
  /// displacements: 3 by n, g_i. Writes the whole field: the shared functions of the first support,
  /// a start point each, then those of the next, then the own ones. Needs a successful build().
  FieldStatus solve(const Points& displacements, CsrbfField& field);

  const SolverEffort& effort() const noexcept;

private:
  class State;
  friend CsrbfSolver solver_with(const CsrbfOptions&, const SolverChoices&);

  std::unique_ptr<State> state_;
};

} // namespace nendo::deform
