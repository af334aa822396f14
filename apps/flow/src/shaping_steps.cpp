// The part of Shaping that undoes and redoes steps. It stores no shapes: each version of the model
// has them (deform::SculptedShape), and notes there lead on to other settings, puppets and
// versions.

#include <nendo/flow/shaping.hpp>

#include <algorithm>
#include <array>

#include <nendo/deform/sculpted_shape.hpp>

namespace nendo::flow {

using deform::FieldStatus;
using deform::HistoryMove;
using deform::Points;
using deform::StepNote;

namespace {

/// The content of a step's note in the history.
struct NotedStep {
  Step step;
  Awaited other; ///< to which an undo of a change leads, or a redo once it is undone

  static NotedStep of(const deform::StepNote& note) noexcept { return note.get<NotedStep>(); }
  deform::StepNote note() const noexcept {
    deform::StepNote note{};
    note.set(*this);
    return note;
  }
};

HistoryMove history_move(Request step) noexcept {
  if (step == Request::undo) return HistoryMove::undo;
  return step == Request::redo ? HistoryMove::redo : HistoryMove::reset;
}

} // namespace

Step Shaping::step_now(StepKind kind) const noexcept {
  return {kind, static_cast<float>(to_seconds(time_))};
}

void Shaping::count(Request step, LoopStats& stats) noexcept {
  ++(step == Request::undo ? stats.undos : step == Request::redo ? stats.redos : stats.resets);
  shaped_ = in_step_ = false;
  forget_redo();
}

void Shaping::take_steps(const Points& tips, LoopStats& stats) noexcept {
  model_->shape.set_notes(NotedStep{step_now(StepKind::stroke), {}}.note(),
                          NotedStep{step_now(StepKind::reset), {}}.note());
  awaited_.reset();
  auto due = steps_due_.begin();
  // A step that cannot be done now has changed nothing, and the next tick tries again.
  while (due != steps_due_.end() && take_step(*due, tips, stats))
    ++due;
  steps_due_.erase(steps_due_.begin(), due);
}

/// Returns false if the step cannot be done now.
bool Shaping::take_step(Request step, const Points& tips, LoopStats& stats) noexcept {
  if (step == Request::redo && model_->shape.redo_steps() == 0) return true;
  if (is_change_next(step)) return take_change(step, tips, stats);
  const FieldStatus status = step == Request::undo && is_pulled()
                                 ? sculptor_->undo_uncommitted(tips)
                                 : sculptor_->apply_history(history_move(step), tips);
  if (!is_solved(status)) return false;
  ++shape_jumps_;
  count(step, stats);
  return true;
}

/// Returns whether the step undoes or redoes a change. An undo of the hands' work since
/// the last step comes first.
bool Shaping::is_change_next(Request step) const noexcept {
  if (step == Request::reset) return false;
  const auto other = target_of(step);
  if (!other) return false;
  // What hands pull continues across an edit of their puppet.
  const bool goes_on = other->puppet != puppet_ && is_pulled() && !in_step_;
  return step != Request::undo || goes_on || !is_in_hand();
}

/// Returns the target of the next step, if it is a change.
std::optional<Awaited> Shaping::target_of(Request step) const noexcept {
  const StepNote* const note = model_->shape.next_note(history_move(step));
  if (note == nullptr || !is_change(NotedStep::of(*note).step.kind)) return std::nullopt;
  return NotedStep::of(*note).other;
}

/// Returns false if another thread must first make the other sculptor (Frame::awaited).
bool Shaping::take_change(Request step, const Points& tips, LoopStats& stats) noexcept {
  const auto other = target_of(step);
  if (other != in_effect()) {
    awaited_ = other;
    return false;
  }
  sculptor_->release(false); // there and back: there is nothing to make
  step_over_change(step, *model_, *other);
  if (held_) held_ = is_solved(sculptor_->continue_grab(tips));
  ++shape_jumps_;
  count(step, stats);
  return true;
}

/// Takes the step in the history of that version, where it then leads back to `before`.
void Shaping::step_over_change(Request step, ModelVersion& version,
                               const Awaited& before) noexcept {
  deform::SculptedShape& shape = version.shape;
  const HistoryMove move = history_move(step);
  const StepNote* const next = shape.next_note(move);
  if (next == nullptr || !is_change(NotedStep::of(*next).step.kind)) return; // memory had ended
  NotedStep noted = NotedStep::of(*next);
  noted.other = before;
  shape.set_next_note(move, noted.note());
  shape.pass_mark(move);
}

/// Takes a step to that version. A step between two versions is in the histories of both.
void Shaping::step_to(Request step, ModelVersion& next, const Awaited& before) noexcept {
  step_over_change(step, *model_, {before.settings, next.number, before.puppet});
  if (&next == model_) return;
  step_over_change(step, next, before);
  if (step == Request::undo) next.after = model_;
}

/// Adds a step from these settings to the present ones. Without `is_step`, it extends the last step
/// instead if that was a change of settings.
void Shaping::record_settings(const LoopSettings& before, bool is_step) noexcept {
  deform::SculptedShape& shape = model_->shape;
  const StepNote* const last = is_step ? nullptr : shape.next_note(HistoryMove::undo);
  NotedStep noted{step_now(StepKind::settings), {before, model_->number, puppet_}};
  const bool goes_on =
      last != nullptr && is_setting(NotedStep::of(*last).step.kind) && shape.redo_steps() == 0;
  if (goes_on) noted.other = NotedStep::of(*last).other;
  noted.step.kind = kind_of_change(noted.other.settings, settings_);
  if (goes_on)
    shape.set_next_note(HistoryMove::undo, noted.note());
  else
    shape.mark(noted.note());
}

/// Returns the kind of the step that makes such a model.
static StepKind kind_of(ModelSource source) noexcept {
  constexpr std::array kinds{StepKind::subdivide, StepKind::subdivide, StepKind::refine,
                             StepKind::cut,       StepKind::join,      StepKind::copy,
                             StepKind::remove,    StepKind::topology};
  static_assert(kinds.size() == static_cast<std::size_t>(ModelSource::topology) + 1);
  return kinds[static_cast<std::size_t>(source)];
}

/// Adds the step to that new version, in both histories.
void Shaping::record_model(ModelVersion& next, const LoopSettings& before) noexcept {
  const Step step = step_now(kind_of(next.origin->source));
  next.before = model_;
  model_->after = nullptr; // as mark() forgets what was undone
  model_->shape.mark(NotedStep{step, {before, next.number, puppet_}}.note());
  next.shape.mark(NotedStep{step, {before, model_->number, puppet_}}.note());
}

void Shaping::record_puppet(const Awaited& before, StepKind kind) noexcept {
  model_->shape.mark(
      NotedStep{step_now(kind), {before.settings, model_->number, before.puppet}}.note());
}

// Counts what was shaped since the last step as a step.
std::size_t Shaping::undo_steps() const noexcept {
  const std::size_t steps = steps_to_undo();
  if (is_in_hand()) return steps + 1;
  return held_ && shaped_ ? std::max<std::size_t>(steps, 1) : steps;
}

/// Returns whether the hands have pulled in type 1, which is a step of its own.
bool Shaping::is_pulled() const noexcept {
  return held_ && shaped_ && sculptor_->mode() == Mode::type1;
}

bool Shaping::is_in_hand() const noexcept {
  return in_step_ || is_pulled() || (held_ && shaped_ && sculptor_->mode() != Mode::type1);
}

/// Returns null if memory has ended there, or if a recording began with that version.
const ModelVersion* Shaping::previous_version(const ModelVersion& version) const noexcept {
  return &version == fenced_ || version.shape.forgotten_steps() > 0 ? nullptr : version.before;
}

/// A step between two versions is in the histories of both, and counts once.
std::size_t Shaping::steps_to_undo() const noexcept {
  std::size_t steps = 0;
  for (const ModelVersion* at = model_; at != nullptr; at = previous_version(*at))
    steps += at->shape.undo_steps() - (at != model_ && at->shape.undo_steps() > 0 ? 1 : 0);
  return steps;
}

std::size_t Shaping::steps_to_redo() const noexcept {
  std::size_t steps = 0;
  for (const ModelVersion* at = model_; at != nullptr; at = at->after)
    steps += at->shape.redo_steps() - (at != model_ && at->shape.redo_steps() > 0 ? 1 : 0);
  return steps;
}

/// After a new step, no redo leads to another version.
void Shaping::forget_redo() noexcept {
  if (model_->shape.redo_steps() == 0) model_->after = nullptr;
}

/// Fills the list's first part from its end, the last step first, and moves the steps to the front.
void Shaping::list_undoable(StepList& list) const noexcept {
  std::array<deform::StepNote, StepList::max_undoable> notes;
  std::size_t at = StepList::max_undoable;
  for (const ModelVersion* version = model_; version != nullptr;
       version = previous_version(*version)) {
    const std::size_t count = version->shape.copy_notes(HistoryMove::undo, notes);
    for (std::size_t note = version == model_ ? 0 : 1; note < count && at > 0; ++note)
      list.steps[--at] = NotedStep::of(notes[note]).step;
  }
  list.undoable = static_cast<std::uint32_t>(StepList::max_undoable - at);
  std::copy_n(&list.steps[at], list.undoable, list.steps.begin());
  list.count = list.undoable;
}

void Shaping::list_undone(StepList& list) const noexcept {
  std::array<deform::StepNote, StepList::max_undone> notes;
  const std::size_t max_count = list.undoable + StepList::max_undone;
  for (const ModelVersion* version = model_; version != nullptr; version = version->after) {
    const std::size_t count = version->shape.copy_notes(HistoryMove::redo, notes);
    for (std::size_t note = version == model_ ? 0 : 1; note < count && list.count < max_count;
         ++note)
      list.steps[list.count++] = NotedStep::of(notes[note]).step;
    if (count < version->shape.redo_steps()) return;
  }
}

void Shaping::list_steps(StepList& list) const noexcept {
  constexpr unsigned history_bits = 40;
  const std::uint64_t version = (std::uint64_t{model_->number} << history_bits) +
                                model_->shape.history_version() + 1; // an empty list has 0
  if (list.version == version) return;
  list_undoable(list);
  list_undone(list);
  list.version = version;
}

} // namespace nendo::flow
