#pragma once
// Assembles M with its ties where most start points are out of each other's supports.

#include <optional>
#include <vector>

#include "solver/own_functions.hpp"
#include "solver/ties.hpp"

namespace nendo::deform {

/// The lower triangle, column by column. The diagonal entry comes first, and the others as they
/// were found, since the permutation that follows needs no order.
struct SparseLower {
  std::vector<int> begins{0}; ///< #columns + 1
  std::vector<int> rows;
  std::vector<double> values;

  Eigen::Index size() const noexcept { return static_cast<Eigen::Index>(begins.size()) - 1; }
};

struct SparseAssembly {
  SparseLower lower;
  bool merged = false;
};

/// Returns nothing if there would be more than `max_entries`.
std::optional<SparseAssembly> assemble_sparse(const CsrbfOptions& options, const Points& starts,
                                              const Supports& supports, const OwnFunctions& own,
                                              std::size_t max_entries);

} // namespace nendo::deform
