#pragma once
// Finds the field that moves start points by given displacements (Sato, Savchenko, Ohbuchi 2004,
// section 2.4): s(c_i) = g_i and sum_i a_i q(c_i) = 0 for every q in p's basis.

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>

#include <nendo/deform/field.hpp>
#include <nendo/deform/supports.hpp>

namespace nendo::deform {

/// The polynomial part of the field. The paper uses `linear`. A polynomial is global: with it,
/// moving one point moves the whole model. `none` is the default, and is always solvable.
enum class Polynomial { none, constant, linear };

NENDO_API std::string_view name_of(Polynomial polynomial) noexcept;
NENDO_API std::optional<Polynomial> polynomial_named(std::string_view name) noexcept;

struct CsrbfOptions {
  Wendland kernel = Wendland::c2;
  Polynomial polynomial = Polynomial::none;
  /// Start points closer than this fraction of the smallest shared radius blend their
  /// displacements, fully when they coincide. A pinch therefore stays continuous, and the field
  /// stays below about 0.25 / merge_fraction times the displacements, or five times this bound with
  /// several radii. Beyond this distance, interpolation is exact.
  double merge_fraction = 1e-6;
  /// From 0, compressible, to 1, volume-preserving (volume_kernel.hpp). Above 0 there is no
  /// polynomial, and one field keeps the volume only for short displacements; for longer ones use
  /// MidpointChain.
  double keep_volume = 0.0;
  /// Regularisation: each diagonal entry of the matrix is increased by this fraction of itself.
  /// Above 0, start points reach their displacements only approximately, and close points are not
  /// torn apart.
  double smoothing = 0.0;

  bool keeps_volume() const noexcept { return keep_volume > 0.0; }
};

enum class FieldStatus {
  ok,
  merged,     ///< some start points blended their displacements
  singular,   ///< no usable solution in double precision; the field is unchanged
  too_dense,  ///< too many start points lie in each other's supports; the field is unchanged
  not_finite, ///< an input was NaN, infinite or beyond 1e100, a radius or weight not positive; the
              ///< field is unchanged
};
/// Returns a description of the status for the user.
NENDO_API std::string_view describe(FieldStatus status) noexcept;

constexpr bool is_solved(FieldStatus status) noexcept {
  return status == FieldStatus::ok || status == FieldStatus::merged;
}

struct SolverChoices; // for tests and benchmarks only: src/solver/solver_choices.hpp

/// The cost of the last build(). Up to lean_size points, no clock is read and the times are 0.
struct SolverEffort {
  bool sparse = false;
  Eigen::Index matrix_entries = 0; ///< entries in one triangle of the symmetric matrix
  Eigen::Index factor_entries = 0;
  double order_s = 0.0;    ///< octree ordering
  double assembly_s = 0.0; ///< neighbour search, matrix assembly
  double analysis_s = 0.0; ///< minimum-degree ordering, symbolic factorisation
  double factor_s = 0.0;
};

/// Factorises once for a set of start points, and then solves for any number of displacements. Up
/// to `lean_size` points, build() and solve() do not allocate, lock or make system calls after a
/// first call with equal numbers of points and supports and a field of the same size.
class NENDO_API CsrbfSolver {
public:
  /// Two hands and most puppets have no more points. Up to this size, a dense factorisation costs
  /// less than the analysis for a sparse one.
  static constexpr Eigen::Index lean_size = 100;
  /// Above this number of points, the status is too_dense if a support contains more than an eighth
  /// of them, or if the factor has more than `max_factor_entries` entries (800 MB).
  static constexpr Eigen::Index max_dense_points = 4096;
  static constexpr Eigen::Index max_factor_entries = Eigen::Index{1} << 26;
  /// With keep_volume, whose matrix has three rows per point, the max number of points; above it,
  /// the status is too_dense.
  static constexpr Eigen::Index max_volume_points = 1024;
  /// Max number of pairs of an own function and a start point in its radius; above it, the status
  /// is too_dense.
  static constexpr std::size_t max_own_values = std::size_t{1} << 23;

  explicit CsrbfSolver(CsrbfOptions options);
  ~CsrbfSolver();
  CsrbfSolver(CsrbfSolver&&) noexcept;
  CsrbfSolver& operator=(CsrbfSolver&&) noexcept;

  /// Orders the start points (3 by n), assembles M (supports.hpp) and factorises it by Cholesky,
  /// and then the Schur complement of the polynomial part. Point indices in `supports` must be less
  /// than n.
  FieldStatus build(const Points& starts, const Supports& supports);
  /// Does the same for n radii, one for each start point, with the common radius of with_common().
  FieldStatus build(const Points& starts, const Eigen::VectorXd& radii);
  /// Solves for the displacements g_i (3 by n) after a successful build(). Writes the whole field:
  /// for each shared support in turn, one function per start point, and then the own functions.
  FieldStatus solve(const Points& displacements, CsrbfField& field);

  const SolverEffort& effort() const noexcept;

private:
  class State;
  friend CsrbfSolver solver_with(const CsrbfOptions&, const SolverChoices&);

  std::unique_ptr<State> state_;
};

} // namespace nendo::deform
