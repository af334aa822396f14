#pragma once
// A block as it was before a step or, once the step is undone, as it was after the step. A step's
// first one holds no block but what is noted of the step.

#include <cstdint>

#include <nendo/deform/step_note.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

struct SavedBlock;

/// What is noted of a step, in a list of all steps.
struct StepHead {
  StepNote note;
  SavedBlock* before; ///< the head of the step before; valid while that step is there
  SavedBlock* after;  ///< of the step after it, or null
};

struct SavedBlock {
  static constexpr std::uint32_t head = ~std::uint32_t{0};

  union {
    VertexBlock content;
    StepHead of_step; ///< if `block` is `head`
  };
  std::uint64_t stamp;
  std::uint64_t step; ///< that changed it
  SavedBlock* next;
  SavedBlock* previous;
  std::uint32_t block;
};

} // namespace nendo::deform
