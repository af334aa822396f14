#pragma once
// The paper's partial elimination: p(x) joins the equations as [M Q; Q^T U], with the basis of p at
// the start points in Q's rows, and Cholesky of M leaves a 4 by 4 Schur complement for its weights.

#include <Eigen/Cholesky>

#include "solver/kernel_system.hpp"

namespace nendo::deform {

class PolynomialPart {
public:
  /// Chooses a basis that is orthonormal on the start points. Terms that they do not determine,
  /// such as that along the normal of coplanar points, become zero columns of Q with a 1 in U, so
  /// that their weight is 0.
  void assemble(const Points& starts, Polynomial polynomial);
  /// Eliminates M. `system` must be factorised.
  bool eliminate(KernelSystem& system);
  /// On entry a = M^-1 g; on return `a` holds the coefficients of the solution with p. Returns p's
  /// weights b, by term. `sums` is the wanted Q^T a + U b, which is 0 except for a correction.
  Eigen::Matrix4d solve(Rows& a, const Eigen::Matrix4d& sums) const noexcept;
  /// Computes residual -= Q b.
  void subtract(const Eigen::Matrix4d& b, Rows& residual) const noexcept;
  /// Returns the `sums` with which solve() corrects this solution: -(Q^T a + U b).
  Eigen::Matrix4d missing_sums(const Rows& a, const Eigen::Matrix4d& b) const noexcept;
  /// Returns the coefficients of 1, x, y, z.
  Eigen::Matrix<double, 3, 4> in_world(const Eigen::Matrix4d& b) const noexcept;

private:
  void orthonormalise(const Eigen::Matrix4d& normalise);

  Rows basis_;                        ///< Q
  Rows solved_basis_;                 ///< M^-1 Q
  Eigen::Vector4d undetermined_;      ///< U's diagonal
  Eigen::Matrix4d world_to_basis_;    ///< q(x) from (1, x, y, z)
  Eigen::LLT<Eigen::Matrix4d> schur_; ///< the factor of Q^T M^-1 Q + U
};

} // namespace nendo::deform
