// M stored sparsely: columns of the neighbours that a grid finds, factorised by Eigen.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "geometry/point_grid.hpp"
#include "solver/kernel_system.hpp"
#include "solver/shared_kernel.hpp"

namespace nendo::deform {

namespace {

/// The lower triangle, column by column. The diagonal entry comes first, and the others as they
/// were found, since the permutation that follows needs no order.
struct SparseLower {
  std::vector<int> begins{0}; ///< #columns + 1
  std::vector<int> rows;
  std::vector<double> values;
  bool has_ties = false;

  Eigen::Index size() const noexcept { return static_cast<Eigen::Index>(begins.size()) - 1; }
};

/// Builds one column after the other in a dense one, of which it knows what is in use.
class Columns {
public:
  Columns(const CsrbfOptions& options, const Points& starts, const Supports& supports,
          const OwnFunctions& own)
      : starts_(starts), own_(own), kernel_(options.kernel, supports), ties_(options, supports),
        reach_(std::max(kernel_.reach(), ties_.reach())), squared_reach_(squared_or_more(reach_)),
        grid_(starts, reach_), diagonal_((1.0 + options.smoothing) * kernel_.at(0.0)),
        own_diagonal_(starts.cols()), ties_diagonal_(Eigen::VectorXd::Zero(starts.cols())),
        column_(static_cast<std::size_t>(starts.cols()), 0.0),
        in_use_(static_cast<std::size_t>(starts.cols()), 0),
        functions_of_(static_cast<std::size_t>(starts.cols())) {
    own_.diagonal(own_diagonal_);
    for (std::size_t e = 0; e < own_.size(); ++e)
      for (std::size_t at = 0; at < own_.values(e).size(); ++at)
        functions_of_[own_.values(e)[at].point].push_back({e, at});
  }

  void append(Eigen::Index j, SparseLower& lower) {
    used_.clear();
    add_own(static_cast<std::size_t>(j));
    const Eigen::Vector3d centre = starts_.col(j);
    grid_.visit_near(centre, centre, reach_, [&](std::uint32_t i) {
      if (static_cast<Eigen::Index>(i) > j) add_shared(static_cast<Eigen::Index>(i), j, lower);
    });
    lower.rows.push_back(static_cast<int>(j));
    lower.values.push_back(0.0); // finish_diagonal()
    for (const std::uint32_t i : used_) {
      lower.rows.push_back(static_cast<int>(i));
      lower.values.push_back(column_[i]);
      column_[i] = 0.0;
      in_use_[i] = 0;
    }
    lower.begins.push_back(static_cast<int>(lower.rows.size()));
  }

  void finish_diagonal(SparseLower& lower) const {
    for (Eigen::Index j = 0; j < lower.size(); ++j) {
      const auto at = static_cast<std::size_t>(lower.begins[static_cast<std::size_t>(j)]);
      lower.values[at] = own_diagonal_[j] + (diagonal_ + ties_diagonal_[j]);
    }
  }

private:
  struct Place {
    std::size_t function, at;
  };

  double& entry(std::uint32_t i) {
    if (in_use_[i] == 0) used_.push_back(i);
    in_use_[i] = 1;
    return column_[i];
  }

  void add_own(std::size_t j) {
    for (const Place& place : functions_of_[j]) {
      const auto values = own_.values(place.function);
      const double factor = own_.weight(place.function) * values[place.at].psi;
      for (std::size_t at = place.at + 1; at < values.size(); ++at)
        entry(values[at].point) += factor * values[at].psi;
    }
  }

  void add_shared(Eigen::Index i, Eigen::Index j, SparseLower& lower) {
    const double squared = (starts_.col(i) - starts_.col(j)).squaredNorm();
    if (squared > squared_reach_) return; // most of those in the cells around
    const double distance = std::sqrt(squared);
    if (!(distance < reach_) && distance != 0.0) return;
    double& value = entry(static_cast<std::uint32_t>(i));
    if (distance < ties_.reach() || distance == 0.0) {
      const double size = (own_diagonal_[i] + own_diagonal_[j]) / 2.0;
      const double tie = ties_.strength(distance, size, size - value);
      ties_diagonal_[i] += tie;
      ties_diagonal_[j] += tie;
      value -= tie;
      lower.has_ties = true;
    }
    value += kernel_.at(distance);
  }

  const Points& starts_;
  const OwnFunctions& own_;
  SharedKernel kernel_;
  Ties ties_;
  double reach_;
  double squared_reach_;
  PointGrid grid_;
  double diagonal_; ///< that of the shared part
  Eigen::VectorXd own_diagonal_, ties_diagonal_;
  std::vector<double> column_;
  std::vector<char> in_use_;
  std::vector<std::uint32_t> used_;
  std::vector<std::vector<Place>> functions_of_; ///< a start point's
};

/// Returns nothing if there would be more than `max_entries`.
std::optional<SparseLower> assemble_sparse(const CsrbfOptions& options, const Points& starts,
                                           const Supports& supports, const OwnFunctions& own,
                                           std::size_t max_entries) {
  // Even where own functions meet in the same entries, this many products take seconds.
  constexpr double max_products = 1e9;
  if (own.pairs() > max_products) return std::nullopt;
  Columns columns(options, starts, supports, own);
  SparseLower lower;
  for (Eigen::Index j = 0; j < starts.cols(); ++j) {
    columns.append(j, lower);
    if (lower.rows.size() > max_entries) return std::nullopt;
  }
  columns.finish_diagonal(lower);
  return lower;
}

/// Beyond an eighth of all pairs, dense is as fast: it does five times as many operations per
/// second.
constexpr std::size_t min_sparsity = 8;
/// The limit for M's triangle: a fair part of the factor's limit.
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
    auto lower = assemble_sparse(options, starts, supports, own, most);
    if (!lower) return Assembled::too_dense;
    lower_ = std::move(*lower);
    return lower_.has_ties ? Assembled::merged : Assembled::ok;
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
