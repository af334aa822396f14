#pragma once
// A ring of slots for deformed vertices. Each slot has all vertices in the order of the mesh. The
// writer rewrites only the blocks that changed since that slot was written last.

#include <cstdint>
#include <vector>

#include <nendo/deform/vertex_blocks.hpp>

#include "publish/record_ring.hpp"

namespace nendo::publish {

/// Returns the least length, in words, of a slot for that many vertices: nendo_publish_shape and
/// then the floats.
std::size_t shape_slot_words(std::size_t vertices) noexcept;

class ShapeRing {
public:
  ShapeRing() = default;
  /// `memory` must have slots * slot_words zeros and must outlive the ring. slot_words must be at
  /// least shape_slot_words(). Allocates; the other functions do not.
  ShapeRing(AtomicWord* memory, std::size_t slots, std::size_t slot_words, std::size_t vertices);

  /// To be called before a loop's first frame. `layout` must have that many vertices, and must
  /// exist as long as shapes are written.
  void begin(const deform::BlockLayout& layout) noexcept { layout_ = &layout; }
  /// Writes the shape that belongs to record `number`. Numbers begin with 1 and rise by 1.
  /// Wait-free, without allocation. The cost is a look at each block's stamp, and three stores for
  /// each vertex of the changed blocks.
  void write(std::uint64_t number, const deform::BlockShape& shape) noexcept;
  /// Returns how often a shape differed from the previous one.
  std::uint64_t changes() const noexcept { return changes_; }

private:
  using Stamps = std::vector<std::uint64_t>;
  void write_block(const deform::BlockShape& shape, std::size_t block, AtomicWord* slot) noexcept;

  AtomicWord* memory_ = nullptr;
  std::size_t slot_words_ = 0;
  std::size_t vertices_ = 0;
  std::vector<Stamps> stamps_; ///< by slot: the stamps of the blocks that are in it
  const deform::BlockLayout* layout_ = nullptr;
  std::uint64_t changes_ = 0;
};

} // namespace nendo::publish
