#pragma once
// Deformed vertices in slots, each whole and in the mesh's own order, of which the writer rewrites
// only the blocks that changed since that slot's last turn.

#include <cstdint>
#include <vector>

#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/publish/record_ring.hpp>

namespace nendo::publish {

/// How long a slot for so many vertices is at least: nendo_publish_shape, then their floats.
std::size_t shape_slot_words(std::size_t vertices) noexcept;

class ShapeRing {
public:
  ShapeRing() = default;
  /// `memory` has slots * slot_words zeros, a slot at least shape_slot_words() of them, and
  /// outlives this. Allocates, which nothing does afterwards.
  ShapeRing(AtomicWord* memory, std::size_t slots, std::size_t slot_words, std::size_t vertices);

  /// Before a loop's first frame; `layout` is of so many vertices, and lives as long as its shapes
  /// are written.
  void begin(const deform::BlockLayout& layout) noexcept { layout_ = &layout; }
  /// Wait-free, no allocation: the shape that belongs to record `number`. Numbers begin with 1 and
  /// rise by 1. Costs a look at each block's stamp, and three stores for each vertex of those that
  /// changed.
  void write(std::uint64_t number, const deform::BlockShape& shape) noexcept;
  /// How often a shape was another one than that before.
  std::uint64_t changes() const noexcept { return changes_; }

private:
  using Stamps = std::vector<std::uint64_t>;
  void write_block(const deform::BlockShape& shape, std::size_t block, AtomicWord* slot) noexcept;

  AtomicWord* memory_ = nullptr;
  std::size_t slot_words_ = 0;
  std::size_t vertices_ = 0;
  std::vector<Stamps> stamps_; ///< by slot: what stands there, remembered here
  const deform::BlockLayout* layout_ = nullptr;
  std::uint64_t changes_ = 0;
};

} // namespace nendo::publish
