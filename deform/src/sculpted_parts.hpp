#pragma once
// What the deformers of a shape work on.

#include <nendo/deform/sculpted_shape.hpp>

#include "block_evaluator.hpp"
#include "shape_history.hpp"

namespace nendo::deform {

struct SculptedShape::Parts {
  BoundedShape original;
  BoundedShape now;
  ShapeHistory history;
  StepNote note{}; ///< of the next step
  StepNote note_of_reset{};

  /// Ends a step, which led to the present shape.
  void keep() noexcept { history.keep(now.shape, note); }
  /// Makes the original shape the present one. Both ways are steps in the history.
  void reset() noexcept {
    keep();
    now.follow(original);
    history.keep(now.shape, note_of_reset);
  }
};

} // namespace nendo::deform
