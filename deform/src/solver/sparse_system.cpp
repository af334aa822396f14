#include <algorithm>
#include <utility>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "solver/kernel_system.hpp"
#include "solver/sparse_assembly.hpp"

namespace nendo::deform {

namespace {

/// Beyond an eighth of all pairs, dense is as fast: it does five times as many operations a second.
constexpr std::size_t min_sparsity = 8;
/// Of M's triangle: a fair part of what the factor may have.
constexpr std::size_t max_matrix_entries = CsrbfSolver::max_factor_entries / 2;

/// Below, what minimum degree takes from the factor's time is less than it takes itself.
constexpr Eigen::Index min_minimum_degree_points = 800;

using Matrix = Eigen::SparseMatrix<double>;

/// Of the upper triangle in the order that it comes in.
class Cholesky final
    : public Eigen::SimplicialLLT<Matrix, Eigen::Upper, Eigen::NaturalOrdering<int>> {
public:
  Eigen::Index entries() const {
    Eigen::Index sum = m_nonZerosPerCol.size();
    for (const int count : m_nonZerosPerCol)
      sum += count;
    return sum;
  }
};

class SparseSystem final : public KernelSystem {
public:
  explicit SparseSystem(bool must) : must_(must) {}

  Assembled assemble(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                     const OwnFunctions& own) override {
    const auto n = static_cast<std::size_t>(starts.cols());
    std::size_t most = max_matrix_entries;
    if (!must_) most = std::min(most, n * (n + 1) / 2 / min_sparsity);
    auto assembly = assemble_sparse(options, starts, supports, own, most);
    if (!assembly) return Assembled::too_dense;
    lower_ = std::move(assembly->lower);
    return assembly->merged ? Assembled::merged : Assembled::ok;
  }

  bool analyse(PointOrder order) override {
    const Eigen::Map<const Matrix> lower(lower_.size(), lower_.size(), matrix_entries(),
                                         lower_.begins.data(), lower_.rows.data(),
                                         lower_.values.data());
    const auto symmetric = lower.selfadjointView<Eigen::Lower>();
    const bool is_large = lower_.size() >= min_minimum_degree_points;
    if (order == PointOrder::minimum_degree || (order == PointOrder::by_size && is_large)) {
      Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> from_place;
      Eigen::AMDOrdering<int>()(symmetric, from_place);
      to_place_ = from_place.inverse();
    } else {
      to_place_.setIdentity(lower_.size());
    }
    upper_.resize(lower_.size(), lower_.size());
    upper_.selfadjointView<Eigen::Upper>() = symmetric.twistedBy(to_place_);
    cholesky_.analyzePattern(upper_);
    return cholesky_.entries() <= CsrbfSolver::max_factor_entries;
  }

  bool factorise(double ridge) override {
    cholesky_.setShift(ridge);
    cholesky_.factorize(upper_);
    return cholesky_.info() == Eigen::Success;
  }

  /// All columns of the right side in one pass over the factor, which is larger than the caches.
  void solve_in_place(Rows& rows) override {
    placed_.noalias() = to_place_ * rows;
    const Matrix& factor = cholesky_.matrixL().nestedExpression();
    const int* const begins = factor.outerIndexPtr();
    const int* const indices = factor.innerIndexPtr();
    const double* const values = factor.valuePtr();
    for (Eigen::Index k = 0; k < placed_.rows(); ++k) {
      const Eigen::RowVector4d solved = placed_.row(k) / values[begins[k]];
      placed_.row(k) = solved;
      for (int at = begins[k] + 1; at < begins[k + 1]; ++at)
        placed_.row(indices[at]) -= values[at] * solved;
    }
    for (Eigen::Index k = placed_.rows() - 1; k >= 0; --k) {
      Eigen::RowVector4d sum = placed_.row(k);
      for (int at = begins[k] + 1; at < begins[k + 1]; ++at)
        sum -= values[at] * placed_.row(indices[at]);
      placed_.row(k) = sum / values[begins[k]];
    }
    rows.noalias() = to_place_.transpose() * placed_;
  }

  void subtract_product(const Rows& x, Rows& residual) const override {
    for (Eigen::Index j = 0; j < lower_.size(); ++j) {
      const auto column = static_cast<std::size_t>(j);
      const auto begin = static_cast<std::size_t>(lower_.begins[column]);
      const auto end = static_cast<std::size_t>(lower_.begins[column + 1]);
      const Eigen::RowVector4d own = x.row(j);
      Eigen::RowVector4d sum = lower_.values[begin] * own;
      for (std::size_t at = begin + 1; at < end; ++at) {
        const int i = lower_.rows[at];
        sum += lower_.values[at] * x.row(i);
        residual.row(i) -= lower_.values[at] * own;
      }
      residual.row(j) -= sum;
    }
  }

  Eigen::Index matrix_entries() const noexcept override {
    return static_cast<Eigen::Index>(lower_.rows.size());
  }
  Eigen::Index factor_entries() const noexcept override { return cholesky_.entries(); }

private:
  bool must_;
  SparseLower lower_;
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> to_place_;
  Matrix upper_;
  Cholesky cholesky_;
  Rows placed_;
};

} // namespace

std::unique_ptr<KernelSystem> make_sparse_system(bool must) {
  return std::make_unique<SparseSystem>(must);
}

} // namespace nendo::deform
