#pragma once
// M of the equations (supports.hpp), with the own functions and the ties in it, and its Cholesky
// factor. There are three ways to store them, by the number of start points and of their
// neighbours.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "solver/solver_choices.hpp"

namespace nendo::deform {

/// A row for each start point, with three coordinates and an unused number, or with the four terms
/// of the polynomial. A row fills two SSE registers or one of AVX.
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// Psi of supports.hpp: the values of each own function at the start points within its radius, and
/// what it adds to the matrix and to the field.
class OwnFunctions {
public:
  struct Value {
    std::uint32_t point;
    double psi;
  };

  /// Evaluates the functions, with a grid if there are many points. Allocates unless as many values
  /// fitted before. Returns false if there are more than CsrbfSolver::max_own_values.
  bool evaluate(Wendland kernel, const Points& starts, const Supports& supports);

  std::size_t size() const noexcept { return weights_.size(); }
  /// Returns the values of one function, by ascending point.
  std::span<const Value> values(std::size_t function) const noexcept {
    return {values_.data() + begins_[function], begins_[function + 1] - begins_[function]};
  }
  double weight(std::size_t function) const noexcept { return weights_[function]; }
  /// Returns a bound of the pairs of points that share a function, and so of the work and of the
  /// entries.
  double pairs() const noexcept;
  /// Returns the trace of Psi W Psi^T.
  double trace() const noexcept;
  /// Writes the diagonal of Psi W Psi^T, one entry per point.
  void diagonal(Eigen::VectorXd& out) const noexcept;
  /// Returns the function's coefficient w_e sum_i psi_e(c_i) a_i.
  Eigen::RowVector4d coefficient(std::size_t function, const Rows& a) const noexcept;

private:
  std::vector<std::size_t> begins_{0};
  std::vector<Value> values_;
  std::vector<double> weights_;
};

class KernelSystem {
public:
  enum class Assembled { ok, merged, too_dense };

  virtual ~KernelSystem() = default;
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

/// Returns the coefficient of an own function of a field that keeps the volume, from the solution
/// a: three rows per start point, of which the first column counts.
Eigen::Vector3d own_volume_coefficient(const CsrbfOptions& options, const Points& starts,
                                       const OwnSupport& own, const Rows& a) noexcept;

} // namespace nendo::deform
