#pragma once
// Keeps the volume of a closed surface: what is pressed in comes out where nothing touches. Each
// block knows its part of the volume, which is computed again only where vertices have moved.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/vertex_blocks.hpp>

#include "clay/contact_search.hpp"
#include "clay/ring_layout.hpp"
#include "field/block_evaluator.hpp"

namespace nendo::deform {

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
