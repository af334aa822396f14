#pragma once
// What stands in the history with each step.

#include <nendo/deform/step_note.hpp>
#include <nendo/flow/frame.hpp>

namespace nendo::flow {

struct NotedStep {
  Step step;
  Awaited other; ///< of a change: that to which undo, or once it is undone redo, leads

  static NotedStep of(const deform::StepNote& note) noexcept { return note.get<NotedStep>(); }
  deform::StepNote note() const noexcept {
    deform::StepNote note{};
    note.set(*this);
    return note;
  }
};

} // namespace nendo::flow
