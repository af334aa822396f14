#include "solver/sparse_assembly.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/point_grid.hpp"
#include "solver/shared_kernel.hpp"

namespace nendo::deform {

namespace {

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

  void append(Eigen::Index j, SparseAssembly& out) {
    used_.clear();
    add_own(static_cast<std::size_t>(j));
    const Eigen::Vector3d centre = starts_.col(j);
    grid_.visit_near(centre, centre, reach_, [&](std::uint32_t i) {
      if (static_cast<Eigen::Index>(i) > j) add_shared(static_cast<Eigen::Index>(i), j, out);
    });
    SparseLower& lower = out.lower;
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

  void add_shared(Eigen::Index i, Eigen::Index j, SparseAssembly& out) {
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
      out.merged = true;
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
  double diagonal_; ///< of the shared part
  Eigen::VectorXd own_diagonal_, ties_diagonal_;
  std::vector<double> column_;
  std::vector<char> in_use_;
  std::vector<std::uint32_t> used_;
  std::vector<std::vector<Place>> functions_of_; ///< a start point's
};

} // namespace

std::optional<SparseAssembly> assemble_sparse(const CsrbfOptions& options, const Points& starts,
                                              const Supports& supports, const OwnFunctions& own,
                                              std::size_t max_entries) {
  // Even where own functions meet in the same entries, this many products take seconds.
  constexpr double max_products = 1e9;
  if (own.pairs() > max_products) return std::nullopt;
  Columns columns(options, starts, supports, own);
  SparseAssembly assembly;
  for (Eigen::Index j = 0; j < starts.cols(); ++j) {
    columns.append(j, assembly);
    if (assembly.lower.rows.size() > max_entries) return std::nullopt;
  }
  columns.finish_diagonal(assembly.lower);
  return assembly;
}

} // namespace nendo::deform
