#include <Eigen/Cholesky>

#include "solver/dense_assembly.hpp"
#include "solver/kernel_system.hpp"
#include "solver/volume_assembly.hpp"

namespace nendo::deform {

namespace {

class DenseSystem final : public KernelSystem {
public:
  Assembled assemble(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                     const OwnFunctions& own) override {
    const bool keeps_volume = options.keep_volume > 0.0;
    const Eigen::Index rows = keeps_volume ? 3 * starts.cols() : starts.cols();
    lower_.resize(rows, rows);
    diagonal_.resize(rows);
    const bool merged = keeps_volume
                            ? assemble_volume(options, starts, supports, lower_)
                            : assemble_dense(options, starts, supports, own, lower_, diagonal_);
    return merged ? Assembled::merged : Assembled::ok;
  }

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

  Eigen::Index matrix_entries() const noexcept override {
    return lower_.rows() * (lower_.rows() + 1) / 2;
  }
  Eigen::Index factor_entries() const noexcept override { return matrix_entries(); }

private:
  Eigen::MatrixXd lower_;
  Eigen::VectorXd diagonal_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  mutable Eigen::MatrixX4d columns_, product_; ///< scratch
};

} // namespace

std::unique_ptr<KernelSystem> make_dense_system() {
  return std::make_unique<DenseSystem>();
}

} // namespace nendo::deform
