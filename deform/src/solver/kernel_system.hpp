#pragma once
// M of the equations (supports.hpp), with the ties in it, and its Cholesky factor. There are three
// ways to store them, by the number of start points and of their neighbours.

#include <memory>

#include "solver/own_functions.hpp"
#include "solver/solver_choices.hpp"

namespace nendo::deform {

class KernelSystem {
public:
  enum class Assembled { ok, merged, too_dense };

  virtual ~KernelSystem() = default;
  /// Allocates for this many rows, in systems whose assemble() must not allocate.
  virtual void reserve(Eigen::Index) {}
  /// Assembles M. The start points are in the order of elimination, unless factorise() reorders
  /// them.
  virtual Assembled assemble(const CsrbfOptions& options, const Points& starts,
                             const Supports& supports, const OwnFunctions& own) = 0;
  /// Determines the pattern of M's factor, in systems that need it in advance. Returns false if the
  /// factor is too large.
  virtual bool analyse(PointOrder) { return true; }
  /// Factorises M + ridge I. Returns false if that is not positive definite in double.
  virtual bool factorise(double ridge) = 0;
  /// Computes rows = (M + ridge I)^-1 rows.
  virtual void solve_in_place(Rows& rows) = 0;
  /// Computes residual -= M x.
  virtual void subtract_product(const Rows& x, Rows& residual) const = 0;
  virtual Eigen::Index matrix_entries() const noexcept = 0;
  virtual Eigen::Index factor_entries() const noexcept = 0;
};

/// Returns a system for up to CsrbfSolver::lean_size points, which loops over storage that only
/// grows: no allocation once it has had as many rows.
std::unique_ptr<KernelSystem> make_lean_system();
/// Returns a system that uses Eigen's blocked Cholesky.
std::unique_ptr<KernelSystem> make_dense_system();
/// Returns a system that finds neighbours by a grid and uses Eigen's simplicial Cholesky. Its
/// assemble() refuses a matrix that is so full that the dense way costs less, unless `must` is set.
std::unique_ptr<KernelSystem> make_sparse_system(bool must);

} // namespace nendo::deform
