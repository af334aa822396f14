#pragma once
// Weights that scale the displacement of each vertex, from 0 (it does not move, bit for bit) to 1
// (it is free). A masked displacement w(x) s(x) is still linear in the control vectors, but its
// derivative includes that of w. So injective links (InjectiveChain) guarantee nothing where 0 < w
// < 1, and a surface can fold there.

#include <array>
#include <cstdint>
#include <vector>

#include <nendo/deform/index.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// Immutable: thread-safe.
class NENDO_API VertexMask {
public:
  /// A block with vertices that are not free.
  struct Part {
    std::uint32_t block = 0;
    bool is_still = false; ///< no vertex of the block moves
    alignas(64) std::array<float, block_size> weights{};
  };

  /// weights: one for each vertex of the layout's mesh, 0 to 1. Allocates.
  VertexMask(const BlockLayout& layout, const Eigen::VectorXd& weights);

  const std::vector<Part>& parts() const noexcept { return parts_; } ///< in the order of blocks
  /// Returns the weights of the block's vertices; null: all are free.
  const float* of_block(std::size_t block) const noexcept {
    return numbers_[block] == no_index ? nullptr : parts_[numbers_[block]].weights.data();
  }
  /// Scales the displacement of `to` from `from`, which has as many blocks, by the weights. Blocks
  /// that do not move are copied from `from`, with their stamps. Wait-free, without allocation.
  void apply(const BlockShape& from, BlockShape& to) const noexcept;

private:
  std::vector<Part> parts_;
  std::vector<std::uint32_t> numbers_; ///< the number of each block's part, or no_index
};

} // namespace nendo::deform
