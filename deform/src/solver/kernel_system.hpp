#pragma once
// M of the equations (supports.hpp), with the ties in it, and its Cholesky factor; three ways to
// keep them, by the number of start points and of their neighbours.

#include <memory>

#include "solver/own_functions.hpp"
#include "solver/solver_choices.hpp"
#include "solver/ties.hpp"

namespace nendo::deform {

class KernelSystem {
public:
  enum class Assembled { ok, merged, too_dense };

  virtual ~KernelSystem() = default;
  /// Allocates for this many points, where assemble() is not to.
  virtual void reserve(Eigen::Index) {}
  /// starts: in the order of elimination, but for what factorise() does about that.
  virtual Assembled assemble(const CsrbfOptions& options, const Points& starts,
                             const Supports& supports, const OwnFunctions& own) = 0;
  /// What decides how M's factor will be filled, if that is to be known before; false if it is too
  /// large.
  virtual bool analyse(PointOrder) { return true; }
  /// Of M + ridge I; false if that is not positive definite in double.
  virtual bool factorise(double ridge) = 0;
  /// rows = (M + ridge I)^-1 rows.
  virtual void solve_in_place(Rows& rows) = 0;
  /// residual -= M x.
  virtual void subtract_product(const Rows& x, Rows& residual) const = 0;
  virtual Eigen::Index matrix_entries() const noexcept = 0;
  virtual Eigen::Index factor_entries() const noexcept = 0;
};

/// Up to CsrbfSolver::lean_size points: loops over fixed storage, without allocation.
std::unique_ptr<KernelSystem> make_lean_system();
/// Eigen's blocked Cholesky.
std::unique_ptr<KernelSystem> make_dense_system();
/// Finds neighbours by a grid and uses Eigen's simplicial Cholesky. assemble() refuses a matrix
/// that is so full that the dense way costs less, unless `must` is set.
std::unique_ptr<KernelSystem> make_sparse_system(bool must);

} // namespace nendo::deform
