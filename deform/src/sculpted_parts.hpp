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
  StepNote note;
  StepNote note_of_reset;

  /// Makes the original shape the present one. Both ways are steps in the history.
  void reset() noexcept {
    history.keep(now.shape);
    now.follow(original);
    history.set_note(note_of_reset);
    history.keep(now.shape);
    history.set_note(note);
  }
};

} // namespace nendo::deform
