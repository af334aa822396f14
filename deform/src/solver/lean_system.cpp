#include <vector>

#include "solver/dense_assembly.hpp"
#include "solver/kernel_system.hpp"
#include "solver/volume_assembly.hpp"

namespace nendo::deform {

namespace {

class LeanSystem final : public KernelSystem {
public:
  void reserve(Eigen::Index rows) override {
    n_ = rows;
    lower_.resize(n_, n_);
    diagonal_.resize(n_);
    if (n_ <= stride_) return;
    stride_ = n_ + n_ % 2; // columns begin at whole SSE registers
    factor_.resize(static_cast<std::size_t>(stride_ * stride_));
    inverse_pivots_.resize(static_cast<std::size_t>(stride_));
  }

  Assembled assemble(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                     const OwnFunctions& own) override {
    const bool keeps_volume = options.keep_volume > 0.0;
    reserve(keeps_volume ? 3 * starts.cols() : starts.cols());
    const bool merged = keeps_volume
                            ? assemble_volume(options, starts, supports, lower_)
                            : assemble_dense(options, starts, supports, own, lower_, diagonal_);
    return merged ? Assembled::merged : Assembled::ok;
  }

  /// M = L D L^T, Cholesky's without roots, which ten points would wait for one after the other.
  /// Right-looking: each finished column is taken from those after it, which are contiguous.
  bool factorise(double ridge) override {
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

  Eigen::Index matrix_entries() const noexcept override { return n_ * (n_ + 1) / 2; }
  Eigen::Index factor_entries() const noexcept override { return matrix_entries(); }

private:
  using Row = Eigen::RowVector4d;
  std::size_t index(Eigen::Index row, Eigen::Index column) const noexcept {
    return static_cast<std::size_t>(column * stride_ + row);
  }

  Eigen::Index n_ = 0;
  Eigen::Index stride_ = 0; ///< from one column of the factor to the next; never shrinks
  Eigen::MatrixXd lower_;
  Eigen::VectorXd diagonal_;
  std::vector<double> factor_;
  std::vector<double> inverse_pivots_;
};

} // namespace

std::unique_ptr<KernelSystem> make_lean_system() {
  return std::make_unique<LeanSystem>();
}

} // namespace nendo::deform
