#pragma once
// The neighbours of each vertex of a surface, ordered as one meets them going round it,
// counter-clockwise. A row has one neighbour of each vertex of a block. A byte is its number: below
// block_size a lane of the block itself, and above one of the places that are far from it. So what
// a block needs lies together, and is little.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/vertex_blocks.hpp>

#include "geometry/rows_by_key.hpp"
#include "simd/ring_kernels.hpp"

namespace nendo::deform {

class RingLayout {
public:
  /// Allocates. `triangles` are vertices of the mesh, closed and oriented, or none.
  RingLayout(const BlockLayout& layout, std::span<const std::uint32_t> triangles);

  std::size_t max_parts() const noexcept { return max_parts_; } ///< the most of a block
  /// How many neighbours each vertex of a block has.
  const float* counts(std::size_t block) const noexcept {
    return counts_.data() + block * block_size;
  }
  /// The blocks of its vertices and of their neighbours.
  std::span<const std::uint32_t> blocks_around(std::size_t block) const noexcept {
    return blocks_around_[block];
  }
  /// The rows of a block's part.
  std::span<const RingRow> rows(std::size_t block, std::size_t part) const noexcept {
    const Part* const is = &parts_[first_parts_[block] + part];
    return {rows_.data() + is[0].first_row, is[1].first_row - is[0].first_row};
  }
  std::size_t parts(std::size_t block) const noexcept {
    return first_parts_[block + 1] - first_parts_[block];
  }
  /// Writes the vectors to which the rows of a block's part refer. `of_block(other)` has those of a
  /// block.
  template <class OfBlock>
  void fill(std::size_t block, std::size_t part, const OfBlock& of_block,
            RingTable& table) const noexcept {
    begin_table(of_block(block), table);
    const Part* const is = &parts_[first_parts_[block] + part];
    auto* to = table.data() + block_size;
    for (std::size_t at = is[0].first_far; at < is[1].first_far; ++at) {
      const VertexBlock& other = of_block(far_[at] / block_size);
      const std::size_t lane = far_[at] % block_size;
      *to++ = {other.x[lane], other.y[lane], other.z[lane], 0.0F};
    }
  }

private:
  /// Rows of a block whose bytes mean the same places.
  struct Part {
    std::uint32_t first_row, first_far;
  };
  using Fans = RowsByKey<std::uint32_t>; ///< the neighbours of each place in their order

  void add_block(const Fans& fans, std::size_t block);
  void begin_part();
  bool add_row(std::size_t block, std::span<const std::uint32_t> neighbours);
  void list_blocks_around(const Fans& fans, std::size_t blocks);

  std::size_t vertices_;
  std::size_t max_parts_ = 0;
  std::vector<std::uint32_t> first_parts_; ///< the first part of each block, and the end
  std::vector<Part> parts_;                ///< and one after the last
  std::vector<RingRow> rows_;
  std::vector<std::uint32_t> far_; ///< places
  std::vector<float> counts_;
  RowsByKey<std::uint32_t> blocks_around_;
};

} // namespace nendo::deform
