#pragma once
// How far each vertex follows what deforms the model: a weight per vertex, of 0 (nothing moves it,
// bit for bit) to 1 (it is free). A masked displacement w(x) s(x) is still linear in the control
// vectors. But it is no field of a place: the slope of w comes on top of that of s. So links that
// are injective (InjectiveChain) promise nothing where 0 < w < 1, and a surface can fold there.

#include <array>
#include <cstdint>
#include <vector>

#include <nendo/deform/index.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// It does not change: thread-safe.
class NENDO_API VertexMask {
public:
  /// A block of which some vertices are not free.
  struct Part {
    std::uint32_t block = 0;
    bool is_still = false; ///< none of it moves
    alignas(64) std::array<float, block_size> weights{};
  };

  /// weights: one for each vertex of the layout's mesh, 0 to 1. Allocates.
  VertexMask(const BlockLayout& layout, const Eigen::VectorXd& weights);

  const std::vector<Part>& parts() const noexcept { return parts_; } ///< in the order of blocks
  /// Returns the weights of the block's vertices; null: all are free.
  const float* of_block(std::size_t block) const noexcept {
    return numbers_[block] == no_index ? nullptr : parts_[numbers_[block]].weights.data();
  }
  /// Makes `to` what the weights leave of the way to it from `from`, which has as many blocks.
  /// Where nothing moves, `to` gets the block of `from`, with its stamp. Wait-free, without
  /// allocation.
  void hold(const BlockShape& from, BlockShape& to) const noexcept;

private:
  std::vector<Part> parts_;
  std::vector<std::uint32_t> numbers_; ///< the number of each block's part, or no_index
};

/// Makes `to`, where a block was moved to from `from`, what the weights leave of that way.
NENDO_API void hold_block(const VertexMask::Part& part, const VertexBlock& from,
                          VertexBlock& to) noexcept;

} // namespace nendo::deform
