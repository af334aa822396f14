#pragma once
// Writing single vertices into blocks.

#include <cstddef>

#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

inline void set_vertex(VertexBlock& block, std::size_t lane, const Eigen::Vector3f& to) noexcept {
  block.x[lane] = to.x();
  block.y[lane] = to.y();
  block.z[lane] = to.z();
}

/// Makes what a block has beyond its `used` vertices equal to the last of these, as
/// BlockLayout::pack() does.
inline void repeat_last(VertexBlock& block, std::size_t used) noexcept {
  const Eigen::Vector3f last = vertex_in(block, used - 1);
  for (std::size_t lane = used; lane < block_size; ++lane)
    set_vertex(block, lane, last);
}

} // namespace nendo::deform
