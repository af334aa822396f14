#pragma once
// A block as it was before a step or, once the step is undone, as it was after the step.

#include <cstdint>

#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

struct SavedBlock {
  VertexBlock content;
  std::uint64_t stamp;
  std::uint64_t step; ///< that changed it
  SavedBlock* next;
  SavedBlock* previous;
  std::uint32_t block;
};

} // namespace nendo::deform
