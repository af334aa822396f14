#pragma once
// Type-1's weights (simd/weight_kernels.hpp). They are built when the start points are frozen, and
// applied each tick.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/vertex_blocks.hpp>

#include "field/block_evaluator.hpp"
#include "field/block_field.hpp"
#include "simd/weight_kernels.hpp"

namespace nendo::deform {

class CardinalWeights {
public:
  /// Allocates all memory that it will ever use: at most weight_bytes, and what the start points
  /// need. `field` must be as large as those that the solver makes.
  CardinalWeights(const BlockLayout& layout, Eigen::Index starts, CsrbfField field,
                  std::size_t weight_bytes);

  /// Makes the weights of the rest shape for the start points of `solver`, unless the memory does
  /// not suffice, or there are too many start points.
  void build(CsrbfSolver& solver, const BoundedShape& rest, BlockEvaluator& evaluator) noexcept;
  bool is_built() const noexcept { return built_; }
  std::size_t bytes_used() const noexcept {
    return cache_.used_bytes + cache_.used_entries * sizeof(WeightEntry);
  }

  /// Returns whether displacements (3 by #starts, model units) keep the rest shape finite.
  bool fits(const Points& displacements, const BoundedShape& rest) const noexcept;
  /// Computes to = rest + W displacements. The displacements must fit. `to` may be the rest's own
  /// blocks.
  void apply(const Points& displacements, const BlockShape& rest, BlockShape& to,
             BlockEvaluator& evaluator) noexcept;
  /// Updates the bounds of the rest shape. Call it after apply() has written to the rest shape
  /// itself.
  void update_rest_bounds(const Points& displacements, BoundedShape& rest) const noexcept;

private:
  bool solve_units(CsrbfSolver& solver) noexcept;
  void take_coefficients(Eigen::Index start, Eigen::Index axis) noexcept;
  double bound(const Points& displacements) const noexcept;

  Eigen::Vector3d origin_;
  double unit_;
  std::size_t starts_;
  Points unit_displacements_;
  CsrbfField unit_field_;
  std::vector<double> map_;
  std::vector<double> polynomial_;
  VectorArray<double> kernel_scratch_;
  std::size_t entries_;
  std::vector<WeightedBlock> blocks_;
  VectorArray<float> weight_scratch_;
  VectorArray<std::byte> weights_;
  std::vector<WeightEntry> weight_entries_;
  std::vector<std::uint8_t> reached_;
  std::vector<std::array<float, 4>> displacements_; ///< in units
  std::vector<std::array<float, 4>> steps_;         ///< those, times weight_step
  WeightCache cache_{};
  bool built_ = false;
  bool goes_back_ = false; ///< the next apply()
};

} // namespace nendo::deform
