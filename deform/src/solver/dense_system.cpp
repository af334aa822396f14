// M stored densely: for up to a hundred start points by loops that do not allocate, for more by
// Eigen.

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include <nendo/deform/volume_kernel.hpp>

#include "solver/kernel_system.hpp"
#include "solver/shared_kernel.hpp"

namespace nendo::deform {

namespace {

/// lower += Psi W Psi^T.
void add_own(const OwnFunctions& own, Eigen::MatrixXd& lower) {
  for (std::size_t e = 0; e < own.size(); ++e) {
    const auto values = own.values(e);
    for (std::size_t j = 0; j < values.size(); ++j) {
      const double factor = own.weight(e) * values[j].psi;
      for (std::size_t i = j; i < values.size(); ++i)
        lower(values[i].point, values[j].point) += factor * values[i].psi;
    }
  }
}

/// Writes the lower triangle of `lower`, n by n. `diagonal` has n entries and is a scratch array.
/// Returns whether points were tied. Does not allocate.
bool assemble_dense(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                    const OwnFunctions& own, Eigen::MatrixXd& lower, Eigen::VectorXd& diagonal) {
  const Eigen::Index n = starts.cols();
  const SharedKernel kernel(options.kernel, supports);
  const Ties ties(options, supports);
  const bool has_own = own.size() > 0;
  const double squared_reach = squared_or_more(std::max(kernel.reach(), ties.reach()));
  if (has_own) {
    lower.setZero();
    add_own(own, lower);
  }
  // The own functions' part of the diagonal is wanted as it is until all ties are found.
  diagonal.setConstant((1.0 + options.smoothing) * kernel.at(0.0));
  bool merged = false;
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j + 1; i < n; ++i) {
      double value = has_own ? lower(i, j) : 0.0;
      const double squared = (starts.col(i) - starts.col(j)).squaredNorm();
      if (squared > squared_reach) { // of local supports most
        lower(i, j) = value;
        continue;
      }
      const double distance = std::sqrt(squared);
      if (distance < ties.reach() || distance == 0.0) {
        const double size = has_own ? (lower(i, i) + lower(j, j)) / 2.0 : 0.0;
        const double tie = ties.strength(distance, size, size - value);
        diagonal[i] += tie;
        diagonal[j] += tie;
        value -= tie;
        merged = true;
      }
      lower(i, j) = value + kernel.at(distance);
    }
  if (has_own)
    lower.diagonal() += diagonal;
  else
    lower.diagonal() = diagonal;
  return merged;
}

/// Returns the matrix that a function with this support has at an offset from its centre.
Eigen::Matrix3d volume_matrix(const CsrbfOptions& options, double radius,
                              const Eigen::Vector3d& offset) noexcept {
  const Eigen::Vector3d u = offset / radius;
  const VolumeKernel kernel = volume_kernel(options.kernel, options.keep_volume, u.norm());
  Eigen::Matrix3d matrix = kernel.offset * u * u.transpose();
  matrix.diagonal().array() += kernel.identity;
  return matrix;
}

/// lower += w Psi Psi^T of one function.
void add_own_volume(const CsrbfOptions& options, const Points& starts, const OwnSupport& own,
                    Eigen::MatrixXd& lower) {
  const double radius = own.support.radius;
  const auto offset = [&](Eigen::Index i) -> Eigen::Vector3d {
    return starts.col(i) - starts.col(own.point);
  };
  for (Eigen::Index j = 0; j < starts.cols(); ++j) {
    if (!(offset(j).squaredNorm() < radius * radius)) continue;
    const Eigen::Matrix3d at_j = own.support.weight * volume_matrix(options, radius, offset(j));
    for (Eigen::Index i = j; i < starts.cols(); ++i) {
      if (!(offset(i).squaredNorm() < radius * radius)) continue;
      lower.block<3, 3>(3 * i, 3 * j) +=
          volume_matrix(options, radius, offset(i)).lazyProduct(at_j);
    }
  }
}

/// Writes the lower triangle of M, 3n by 3n: sum_s w_s A_s + Psi W Psi^T (supports.hpp) with a
/// matrix for each number, and ties. Returns whether points were tied. Does not allocate.
bool assemble_volume(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                     Eigen::MatrixXd& lower) {
  const Ties ties(options, supports);
  bool merged = false;
  lower.setZero();
  for (const OwnSupport& own : supports.own)
    add_own_volume(options, starts, own, lower);
  for (const Support& support : supports.shared)
    lower.diagonal().array() += options.smoothing * support.weight;
  for (Eigen::Index j = 0; j < starts.cols(); ++j) {
    for (Eigen::Index i = j; i < starts.cols(); ++i) {
      const Eigen::Vector3d offset = starts.col(i) - starts.col(j);
      for (const Support& support : supports.shared)
        if (offset.squaredNorm() < support.radius * support.radius)
          lower.block<3, 3>(3 * i, 3 * j) +=
              support.weight * volume_matrix(options, support.radius, offset);
      const double distance = i == j ? ties.reach() : offset.norm();
      if (i == j || !(distance < ties.reach() || distance == 0.0)) continue;
      const double tie = ties.strength(distance, 0.0, 0.0);
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        lower(3 * i + axis, 3 * i + axis) += tie;
        lower(3 * j + axis, 3 * j + axis) += tie;
        lower(3 * i + axis, 3 * j + axis) -= tie;
      }
      merged = true;
    }
  }
  return merged;
}

/// Systems that store all of M's lower triangle.
class FullSystem : public KernelSystem {
public:
  Assembled assemble(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                     const OwnFunctions& own) override {
    const Eigen::Index rows = options.keeps_volume() ? 3 * starts.cols() : starts.cols();
    lower_.resize(rows, rows);
    diagonal_.resize(rows);
    const bool merged = options.keeps_volume()
                            ? assemble_volume(options, starts, supports, lower_)
                            : assemble_dense(options, starts, supports, own, lower_, diagonal_);
    return merged ? Assembled::merged : Assembled::ok;
  }

  Eigen::Index matrix_entries() const noexcept override {
    return lower_.rows() * (lower_.rows() + 1) / 2;
  }
  Eigen::Index factor_entries() const noexcept override { return matrix_entries(); }

protected:
  Eigen::MatrixXd lower_;
  Eigen::VectorXd diagonal_;
};

class LeanSystem final : public FullSystem {
public:
  /// M = L D L^T, Cholesky's without roots, which ten points would wait for one after the other.
  /// Right-looking: each finished column is taken from those after it, which are contiguous.
  bool factorise(double ridge) override {
    n_ = lower_.rows();
    if (n_ > stride_) {
      stride_ = n_ + n_ % 2; // columns begin at whole SSE registers
      factor_.resize(static_cast<std::size_t>(stride_ * stride_));
      inverse_pivots_.resize(static_cast<std::size_t>(stride_));
    }
    for (Eigen::Index j = 0; j < n_; ++j) {
      for (Eigen::Index i = j; i < n_; ++i)
        factor_[index(i, j)] = lower_(i, j);
      factor_[index(j, j)] += ridge;
    }
    for (Eigen::Index k = 0; k < n_; ++k) {
      double* const column = &factor_[index(0, k)];
      if (!(column[k] > 0.0)) return false;
      const double inverse = 1.0 / column[k];
      inverse_pivots_[static_cast<std::size_t>(k)] = inverse;
      for (Eigen::Index j = k + 1; j < n_; ++j) {
        double* const target = &factor_[index(0, j)];
        const double value = column[j] * inverse;
        for (Eigen::Index i = j; i < n_; ++i)
          target[i] -= value * column[i];
      }
      for (Eigen::Index i = k + 1; i < n_; ++i)
        column[i] *= inverse;
    }
    return true;
  }

  void solve_in_place(Rows& rows) noexcept override {
    for (Eigen::Index k = 0; k < n_; ++k) {
      const double* const column = &factor_[index(0, k)];
      const Row solved = rows.row(k);
      for (Eigen::Index i = k + 1; i < n_; ++i)
        rows.row(i) -= column[i] * solved;
    }
    for (Eigen::Index k = n_ - 1; k >= 0; --k) {
      const double* const column = &factor_[index(0, k)];
      Row sum = Row(rows.row(k)) * inverse_pivots_[static_cast<std::size_t>(k)];
      for (Eigen::Index i = n_ - 1; i > k; --i) // the latest row comes last: only it is waited for
        sum -= column[i] * rows.row(i);
      rows.row(k) = sum;
    }
  }

  void subtract_product(const Rows& x, Rows& residual) const noexcept override {
    for (Eigen::Index j = 0; j < n_; ++j) {
      const Row own = x.row(j);
      Row sum = lower_(j, j) * own;
      for (Eigen::Index i = j + 1; i < n_; ++i) {
        const double value = lower_(i, j);
        sum += value * x.row(i);
        residual.row(i) -= value * own;
      }
      residual.row(j) -= sum;
    }
  }

private:
  using Row = Eigen::RowVector4d;
  std::size_t index(Eigen::Index row, Eigen::Index column) const noexcept {
    return static_cast<std::size_t>(column * stride_ + row);
  }

  Eigen::Index n_ = 0;
  Eigen::Index stride_ = 0; ///< from one column of the factor to the next; never shrinks
  std::vector<double> factor_;
  std::vector<double> inverse_pivots_;
};

class DenseSystem final : public FullSystem {
public:
  bool factorise(double ridge) override {
    diagonal_ = lower_.diagonal();
    lower_.diagonal().array() += ridge;
    cholesky_.compute(lower_);
    lower_.diagonal() = diagonal_;
    return cholesky_.info() == Eigen::Success;
  }

  void solve_in_place(Rows& rows) override {
    columns_ = rows;
    cholesky_.solveInPlace(columns_);
    rows = columns_;
  }

  void subtract_product(const Rows& x, Rows& residual) const override {
    columns_ = x;
    product_.noalias() = lower_.selfadjointView<Eigen::Lower>() * columns_;
    residual -= product_;
  }

private:
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  mutable Eigen::MatrixX4d columns_, product_; ///< scratch
};

} // namespace

std::unique_ptr<KernelSystem> make_lean_system() {
  return std::make_unique<LeanSystem>();
}

std::unique_ptr<KernelSystem> make_dense_system() {
  return std::make_unique<DenseSystem>();
}

Eigen::Vector3d own_volume_coefficient(const CsrbfOptions& options, const Points& starts,
                                       const OwnSupport& own, const Rows& a) noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < starts.cols(); ++i) {
    const Eigen::Vector3d offset = starts.col(i) - starts.col(own.point);
    if (!(offset.squaredNorm() < own.support.radius * own.support.radius)) continue;
    const Eigen::Vector3d at(a(3 * i, 0), a(3 * i + 1, 0), a(3 * i + 2, 0));
    sum += volume_matrix(options, own.support.radius, offset).lazyProduct(at);
  }
  return own.support.weight * sum;
}

} // namespace nendo::deform
