#pragma once
// What each vertex remembers of a body's pressure. Once the clay fits a hand, nothing is deep any
// more, and without a memory the friction would end.

#include <cstdint>
#include <vector>

#include <nendo/deform/vertex_blocks.hpp>

#include "simd/contact_kernels.hpp"

namespace nendo::deform {

/// Lengths are in a layout's coordinates.
class ContactLoad {
public:
  /// Allocates for one body. `most` is the largest load: how far the clay springs back.
  ContactLoad(std::size_t blocks, double most);

  /// Takes note of the distances of a block's vertices.
  void press(std::size_t block, const NearestLanes& nearest) noexcept;
  /// Ends a round of press(): blocks that were not pressed have no load any more.
  void end_round() noexcept;
  void clear() noexcept;

  /// Returns the load of a vertex at that distance: what it was pressed by, less the gap.
  double at(std::uint32_t place, double distance) const noexcept;
  std::uint8_t& slips(std::uint32_t place) noexcept { return slips_[place]; }
  /// Returns whether the last round left any load.
  bool is_any() const noexcept { return was_any_; }

private:
  void clear(std::size_t block) noexcept;

  float max_;
  std::uint64_t round_ = 1;
  bool is_any_ = false, was_any_ = false;
  std::vector<std::uint64_t> rounds_; ///< of each block: the last round with a load; 0: none
  std::vector<float> pressed_;
  std::vector<std::uint8_t> slips_;
};

} // namespace nendo::deform
