#include <nendo/flow/shaping.hpp>

#include <algorithm>
#include <utility>

namespace nendo::flow {

using deform::FieldStatus;
using deform::Points;

namespace {

// What is shaped between changes that are less than this apart is one step for undo.
constexpr HostClock::duration one_step = std::chrono::seconds(1);

// Some whole shapes ahead, so that refill_undo() may be seldom.
std::unique_ptr<deform::UndoMemory> undo_memory_for(const Points& rest,
                                                    const ShapingOptions& options) {
  constexpr std::size_t shapes_ahead = 4;
  if (options.undo_most_bytes == 0) return nullptr;
  const auto blocks = static_cast<std::size_t>(rest.cols()) / deform::block_size + 1;
  return std::make_unique<deform::UndoMemory>(shapes_ahead * blocks, options.undo_most_bytes);
}

deform::DeformerOptions with_memory(deform::DeformerOptions options, deform::UndoMemory* memory) {
  options.undo_memory = memory;
  return options;
}

bool moves_anything(const deform::FieldSequence& sequence) noexcept {
  const auto fields = sequence.fields();
  return std::any_of(fields.begin(), fields.end(), [](const deform::CsrbfField& field) {
    return !field.coefficients.isZero(0.0) || !field.polynomial.isZero(0.0);
  });
}

void count_chain(const deform::ChainReport& chain, LoopStats& stats) noexcept {
  stats.most_links = std::max(stats.most_links, chain.links);
  stats.most_bound = std::max(stats.most_bound, chain.whole_bound);
  stats.least_determinant = std::min(stats.least_determinant, chain.least_determinant);
  if (chain.held_pairs > 0) ++stats.held_apart_ticks;
}

} // namespace

/// What stands in the history with each step.
struct Shaping::NotedStep {
  Step step;
  LoopSettings other; ///< of a change: those to which undo, or once it is undone redo, leads

  static NotedStep of(const deform::StepNote& note) noexcept { return note.get<NotedStep>(); }
  deform::StepNote note() const noexcept {
    deform::StepNote note{};
    note.set(*this);
    return note;
  }
};

Shaping::Shaping(const Points& rest, Eigen::Index control_points, const ShapingOptions& options)
    : undo_memory_(undo_memory_for(rest, options)),
      shape_(rest, with_memory(options.sculptor.options.deformer, undo_memory_.get()),
             options.first),
      control_points_(control_points),
      sculptor_(std::make_unique<Sculptor>(shape_, control_points, options.sculptor.options)),
      held_(options.held), hold_wanted_(held_), settings_(options.sculptor.settings) {
  steps_due_.reserve(options.most_requests);
  refill_undo();
}

void Shaping::ask(Request request) noexcept {
  if (request == Request::grab) hold_wanted_ = true;
  if (request == Request::let_go) hold_wanted_ = false;
  if (request == Request::commit) commit_due_ = held_ || hold_wanted_;
  if (goes_through_history(request) && steps_due_.size() < steps_due_.capacity())
    steps_due_.push_back(request);
}

Step Shaping::step_now(StepKind kind) const noexcept {
  return {kind, static_cast<float>(to_seconds(time_))};
}

void Shaping::count(Request step, LoopStats& stats) noexcept {
  ++(step == Request::undo ? stats.undos : step == Request::redo ? stats.redos : stats.resets);
  shaped_ = in_step_ = false;
}

/// Returns false if the step cannot be done now.
bool Shaping::take_step(Request step, const Points& tips, LoopStats& stats) noexcept {
  if (step == Request::redo && sculptor_->redo_steps() == 0) return true;
  if (is_change_next(step)) return take_change(step, tips, stats);
  const FieldStatus status = step == Request::undo   ? sculptor_->undo(tips)
                             : step == Request::redo ? sculptor_->redo(tips)
                                                     : sculptor_->reset(tips);
  if (!is_solved(status)) return false;
  count(step, stats);
  return true;
}

/// Tells whether the step is to undo or redo a change of settings. What the hands have shaped in a
/// stroke of type 2, or before a change that was no step, comes before it; what they hold in type 1
/// goes with it.
bool Shaping::is_change_next(Request step) const noexcept {
  if (step == Request::reset || (step == Request::undo && is_in_hand())) return false;
  return other_of(step).has_value();
}

/// The settings to which the next step leads, if it is a change.
std::optional<LoopSettings> Shaping::other_of(Request step) const noexcept {
  const deform::StepNote* const note = step == Request::undo ? shape_.to_undo() : shape_.to_redo();
  if (note == nullptr || !is_change(NotedStep::of(*note).step.kind)) return std::nullopt;
  return NotedStep::of(*note).other;
}

/// Only a sculptor with the other settings can do it, which another thread must make.
bool Shaping::take_change(Request step, const Points& tips, LoopStats& stats) noexcept {
  const auto other = other_of(step);
  if (other != settings_) {
    awaited_ = other;
    return false;
  }
  sculptor_->release(false); // there and back: there is nothing to make
  step_over_change(step, settings_);
  if (held_) held_ = is_solved(sculptor_->grab_on(tips));
  count(step, stats);
  return true;
}

/// The sculptor must have let go of the shape.
void Shaping::step_over_change(Request step, const LoopSettings& before) noexcept {
  const bool undoes = step == Request::undo;
  NotedStep noted = NotedStep::of(undoes ? *shape_.to_undo() : *shape_.to_redo());
  noted.other = before;
  undoes ? shape_.note_to_undo(noted.note()) : shape_.note_to_redo(noted.note());
  undoes ? shape_.undo_mark() : shape_.redo_mark();
}

void Shaping::take_steps(const Points& tips, LoopStats& stats) noexcept {
  shape_.set_notes(NotedStep{step_now(StepKind::stroke), {}}.note(),
                   NotedStep{step_now(StepKind::reset), {}}.note());
  awaited_.reset();
  auto due = steps_due_.begin();
  // What cannot be done now has changed nothing, and is tried again at the next tick.
  while (due != steps_due_.end() && take_step(*due, tips, stats))
    ++due;
  steps_due_.erase(steps_due_.begin(), due);
}

// Type-1 drops with an undo what was shaped since the commit that it undoes. Type-2 keeps it as a
// step of its own.
std::size_t Shaping::undo_steps() const noexcept {
  const std::size_t steps = sculptor_->undo_steps();
  if (is_in_hand()) return steps + 1;
  return held_ && shaped_ ? std::max<std::size_t>(steps, 1) : steps;
}

bool Shaping::is_in_hand() const noexcept {
  return in_step_ || (held_ && shaped_ && sculptor_->mode() == Mode::type2);
}

FieldStatus Shaping::shape(const Points& tips, Frame& frame, LoopStats& stats,
                           bool completes) noexcept {
  take_steps(tips, stats);
  if (!held_ && hold_wanted_) {
    held_ = is_solved(sculptor_->grab(tips));
    if (held_) ++stats.grabs;
  }
  make_room(frame.fields);
  FieldStatus status = FieldStatus::ok;
  if (held_) {
    const bool commits = commit_due_ || !hold_wanted_; // letting go keeps what has been shaped
    status = commits || completes ? sculptor_->finish(tips, frame.shape)
                                  : sculptor_->update(tips, frame.shape);
    frame.fields.follow(sculptor_->fields());
    frame.chain = sculptor_->report();
    count_chain(frame.chain, stats);
    const bool moves = moves_anything(frame.fields);
    shaped_ = moves || (shaped_ && sculptor_->mode() == Mode::type2); // type 1 begins at the rest
    // What cannot be committed now stays held, and is tried again at the next tick.
    if (commits && is_solved(status) && is_solved(sculptor_->commit(tips))) {
      ++stats.commits;
      commit_due_ = false;
      shaped_ = in_step_ = false;
      held_ = hold_wanted_;
    }
  } else {
    frame.shape.follow(sculptor_->rest());
    frame.fields.clear();
    frame.chain = {};
  }
  frame.held = held_;
  tell(frame, stats);
  return status;
}

void Shaping::tell(Frame& frame, LoopStats& stats) const noexcept {
  stats.undo_steps = sculptor_->undo_steps();
  stats.forgotten_steps = sculptor_->forgotten_steps();
  frame.commits = stats.commits + otherwise_ended_;
  frame.undos = stats.undos + stats.redos + stats.resets;
  frame.undo_steps = undo_steps();
  frame.redo_steps = sculptor_->redo_steps();
  frame.awaited = awaited_;
  list_steps(frame.steps);
  frame.steps.in_hand = is_in_hand();
}

void Shaping::list_steps(StepList& list) const noexcept {
  const std::uint64_t version = shape_.history_version() + 1; // an empty list has 0
  if (list.version == version) return;
  std::array<deform::StepNote, StepList::most_undoable> notes;
  list.undoable = static_cast<std::uint32_t>(shape_.copy_undoable(notes));
  for (std::size_t at = 0; at < list.undoable; ++at)
    list.steps[list.undoable - 1 - at] = NotedStep::of(notes[at]).step;
  const std::span undone(notes.data(), StepList::most_undone);
  list.count = list.undoable + static_cast<std::uint32_t>(shape_.copy_undone(undone));
  for (std::size_t at = list.undoable; at < list.count; ++at)
    list.steps[at] = NotedStep::of(notes[at - list.undoable]).step;
  list.version = version;
}

/// Takes the room that was made for the present sculptor's fields, if the frame has none for them.
void Shaping::make_room(deform::FieldSequence& fields) noexcept {
  if (fields.has_room_of(sculptor_->fields())) return;
  for (auto& room : room_) {
    if (!room.has_room_of(sculptor_->fields())) continue;
    std::swap(room, fields);
    return;
  }
}

ReadySculptor Shaping::prepare(const SculptorSetup& setup) {
  ReadySculptor ready;
  ready.sculptor = std::make_unique<Sculptor>(shape_, control_points_, setup.options);
  ready.settings = setup.settings;
  ready.room.fill(ready.sculptor->fields());
  return ready;
}

void Shaping::exchange(ReadySculptor& ready, const Points& tips, Frame& frame,
                       LoopStats& stats) noexcept {
  const bool is_step = !exchanged_at_ || time_ - *exchanged_at_ >= one_step;
  exchanged_at_ = time_;
  std::swap(settings_, ready.settings);
  const LoopSettings& before = ready.settings;
  // A commit in this tick may have come before it, and then something else is to be undone next.
  if (awaited_ == settings_ && other_of(steps_due_.front()) == settings_) {
    const Request step = steps_due_.front();
    sculptor_->release(false);
    step_over_change(step, before);
    count(step, stats);
    steps_due_.erase(steps_due_.begin());
  } else {
    sculptor_->release(is_step);
    in_step_ = !is_step && (in_step_ || (held_ && shaped_));
    note_change(before, is_step);
  }
  awaited_.reset();
  shaped_ = false;
  std::swap(sculptor_, ready.sculptor);
  std::swap(room_, ready.room);
  // Hands that cannot take hold now try it again at each tick.
  if (held_) held_ = is_solved(sculptor_->grab_on(tips));
  ++otherwise_ended_;
  ++stats.changes;
  tell(frame, stats);
}

/// Adds a step from these settings to the present ones, or lets the last one, if it is a change and
/// not `is_step`, lead here.
void Shaping::note_change(const LoopSettings& before, bool is_step) noexcept {
  const deform::StepNote* const last = is_step ? nullptr : shape_.to_undo();
  NotedStep noted{step_now(StepKind::settings), before};
  const bool goes_on =
      last != nullptr && is_change(NotedStep::of(*last).step.kind) && shape_.redo_steps() == 0;
  if (goes_on) noted.other = NotedStep::of(*last).other;
  noted.step.kind = kind_of_change(noted.other, settings_);
  if (goes_on)
    shape_.note_to_undo(noted.note());
  else
    shape_.mark(noted.note());
}

void Shaping::begin_anew(const Points& tips, bool fences, Frame& frame, LoopStats& stats) noexcept {
  sculptor_->release(true);
  shaped_ = in_step_ = commit_due_ = false;
  exchanged_at_.reset();
  steps_due_.clear();
  awaited_.reset();
  fences ? shape_.fence() : shape_.unfence();
  const bool takes_hold = is_solved(sculptor_->grab(tips));
  held_ = hold_wanted_ = held_ && takes_hold;
  ++otherwise_ended_;
  tell(frame, stats);
}

Points Shaping::final_shape(const Points& tips) {
  deform::BlockShape shape = sculptor_->rest();
  if (held_) sculptor_->finish(tips, shape);
  Points vertices;
  layout().unpack(shape, vertices);
  return vertices;
}

} // namespace nendo::flow
