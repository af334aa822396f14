#pragma once
// What the deformers of a shape work on.

#include <utility>

#include <nendo/deform/sculpted_shape.hpp>

#include "field/block_evaluator.hpp"
#include "history/shape_history.hpp"

namespace nendo::deform {

struct SculptedShape::Parts {
  BoundedShape original;
  BoundedShape now;
  ShapeHistory history;
  StepNote note{}; ///< of the next step
  StepNote note_of_reset{};
  /// Whether `now` may differ from the shape that was kept last. To find out reads a stamp a block,
  /// which is too much for the tick that takes another version of a large model.
  bool is_changed = false;

  /// Returns the present shape, for writing.
  BoundedShape& change() noexcept {
    is_changed = true;
    return now;
  }
  /// Ends a step, which led to the present shape.
  void keep() noexcept {
    if (std::exchange(is_changed, false)) history.keep(now.shape, note);
  }
  /// Makes the present shape the one that was kept last.
  void revert() noexcept {
    if (std::exchange(is_changed, false)) history.revert(now);
  }
  /// What was made since the last step is a step, but in a redo, which drops it.
  void go(HistoryMove move) noexcept {
    if (move == HistoryMove::redo) {
      revert();
      history.redo(now);
      return;
    }
    keep();
    if (move == HistoryMove::undo) {
      history.undo(now);
    } else {
      now.follow(original);
      history.keep(now.shape, note_of_reset);
    }
  }
};

} // namespace nendo::deform
