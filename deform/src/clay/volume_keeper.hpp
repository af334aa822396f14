#pragma once
// Keeps the volume of a closed surface: what is pressed in comes out where nothing touches. Each
// block knows its part of the volume, which is computed again only where vertices have moved.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/vertex_blocks.hpp>

#include "clay/contact_search.hpp"
#include "field/block_evaluator.hpp"
#include "geometry/rows_by_key.hpp"
#include "simd/ring_kernels.hpp"

namespace nendo::deform {

/// The neighbours of each vertex of a surface, ordered as one meets them going round it,
/// counter-clockwise. A row has one neighbour of each vertex of a block. A byte is its number:
/// below block_size a lane of the block itself, and above one of the places that are far from it.
/// So what a block needs lies together, and is little.
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

/// Lengths are in a layout's coordinates.
struct GiveBack {
  double near;           ///< from a body's surface to here the surface is less and less held
  double most;           ///< a vertex goes in one call
  const BoxGate* around; ///< where the bodies touch; null: everything is to swell alike
  double reach;          ///< from this box to here it swells less and less
};

class VolumeKeeper {
public:
  /// Allocates. `triangles` are vertices of the mesh.
  VolumeKeeper(const BlockLayout& layout, std::span<const std::uint32_t> triangles);

  /// Returns whether the triangles are a closed, oriented surface: each edge is run along once in
  /// each direction. Otherwise there is no volume, and the other functions must not be called.
  bool is_closed() const noexcept { return ring_layout_.has_value(); }
  /// Returns the volume of that shape. Does not allocate.
  double volume(const BoundedShape& shape) noexcept;
  /// The next volume() then measures all again. Between, only what has changed is measured, and the
  /// directions in which the shape swells are, to rounding, those of the calls before.
  void forget() noexcept;
  /// Somebody has changed that block, and its stamp has stayed.
  void read_again(std::size_t block) noexcept {
    if (is_closed()) stamps_[block] = 0;
  }
  /// Moves what is free along its normals, so that the volume grows by `missing`, or by what
  /// GiveBack::most permits. Call volume() first. Returns how much it grew, to second order. Does
  /// not allocate.
  double give_back(BoundedShape& shape, ContactSearch& search, double missing,
                   const GiveBack& how) noexcept;

  /// Of each block, as the last volume() has found them.
  std::span<const RingFacts> facts() const noexcept { return facts_; }
  std::span<const RingBlock> rings() const noexcept { return measured_; }

private:
  void measure(const BoundedShape& shape, std::size_t block, bool turns) noexcept;
  std::size_t end_of(std::size_t block) const noexcept {
    return std::min(vertices_, (block + 1) * block_size);
  }
  bool has_changed(const BoundedShape& shape, std::size_t block) const noexcept;
  void weigh(const BoundedShape& shape, ContactSearch& search, const GiveBack& how) noexcept;
  void sum_rates() noexcept;
  double distance_for(double missing, double most) const noexcept;
  double swell(BoundedShape& shape, double far, double fairness) noexcept;
  void finish_blocks(BoundedShape& shape) noexcept;

  std::size_t vertices_;
  std::optional<RingLayout> ring_layout_; ///< only for a closed surface
  std::vector<std::uint64_t> stamps_;     ///< the blocks' stamps when they were measured
  std::vector<RingFacts> facts_;          ///< one per block
  std::vector<std::uint8_t> is_turned_;   ///< its directions have changed since it was measured
  std::vector<std::uint8_t> is_free_;     ///< one per block: some weight is not 0
  std::vector<RingBlock> measured_;
  std::vector<float> weights_;
  std::vector<RingTable> points_, directions_; ///< the tables of one block's parts
  std::vector<RingPart> parts_;
  std::size_t calls_ = 0; ///< the calls of volume() since forget()
  double rate_ = 0.0;     ///< growth of the volume with the distance
  double bend_ = 0.0;     ///< and with its square
};

} // namespace nendo::deform
