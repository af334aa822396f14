#include <nendo/flow/shaping.hpp>

#include <algorithm>
#include <utility>

namespace nendo::flow {

using deform::FieldStatus;
using deform::Points;

namespace {

// Some whole shapes ahead, so that refill_undo() may be seldom.
std::unique_ptr<deform::UndoMemory> undo_memory_for(const Points& rest,
                                                    const ShapingOptions& options) {
  constexpr std::size_t shapes_ahead = 4;
  if (options.undo_most_bytes == 0) return nullptr;
  const auto blocks = static_cast<std::size_t>(rest.cols()) / deform::block_size + 1;
  return std::make_unique<deform::UndoMemory>(shapes_ahead * blocks, options.undo_most_bytes);
}

SculptorOptions with_memory(SculptorOptions options, deform::UndoMemory* memory) {
  options.deformer.undo_memory = memory;
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

Shaping::Shaping(const Points& rest, Eigen::Index control_points, const ShapingOptions& options)
    : undo_memory_(undo_memory_for(rest, options)),
      shape_(rest, with_memory(options.sculptor, undo_memory_.get()).deformer, options.first),
      control_points_(control_points),
      sculptor_(std::make_unique<Sculptor>(shape_, control_points, options.sculptor)),
      held_(options.held), hold_wanted_(held_) {
  steps_due_.reserve(options.most_requests);
  refill_undo();
}

void Shaping::ask(Request request) noexcept {
  if (request == Request::grab) hold_wanted_ = true;
  if (request == Request::let_go) hold_wanted_ = false;
  if (request == Request::commit) commit_due_ = held_ || hold_wanted_;
  const bool steps =
      request == Request::undo || request == Request::redo || request == Request::reset;
  if (steps && steps_due_.size() < steps_due_.capacity()) steps_due_.push_back(request);
}

/// Returns false if the step cannot be done now.
bool Shaping::take_step(Request step, const Points& tips, LoopStats& stats) noexcept {
  if (step == Request::redo && sculptor_->redo_steps() == 0) return true;
  const FieldStatus status = step == Request::undo   ? sculptor_->undo(tips)
                             : step == Request::redo ? sculptor_->redo(tips)
                                                     : sculptor_->reset(tips);
  if (!is_solved(status)) return false;
  ++(step == Request::undo ? stats.undos : step == Request::redo ? stats.redos : stats.resets);
  shaped_ = in_step_ = false;
  return true;
}

void Shaping::take_steps(const Points& tips, LoopStats& stats) noexcept {
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
  if (in_step_) return steps + 1;
  if (!held_ || !shaped_) return steps;
  return sculptor_->mode() == Mode::type2 ? steps + 1 : std::max<std::size_t>(steps, 1);
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

ReadySculptor Shaping::prepare(const SculptorOptions& options) {
  ReadySculptor ready;
  ready.sculptor = std::make_unique<Sculptor>(shape_, control_points_, options);
  ready.room.fill(ready.sculptor->fields());
  return ready;
}

void Shaping::exchange(ReadySculptor& ready, const Points& tips, bool is_step, Frame& frame,
                       LoopStats& stats) noexcept {
  sculptor_->release(is_step);
  in_step_ = !is_step && (in_step_ || (held_ && shaped_));
  shaped_ = false;
  std::swap(sculptor_, ready.sculptor);
  std::swap(room_, ready.room);
  // Hands that cannot take hold now try it again at each tick.
  if (held_) held_ = is_solved(sculptor_->grab_on(tips));
  ++otherwise_ended_;
  ++stats.changes;
  tell(frame, stats);
}

void Shaping::begin_anew(const Points& tips, bool fences, Frame& frame, LoopStats& stats) noexcept {
  sculptor_->release(true);
  shaped_ = in_step_ = commit_due_ = false;
  steps_due_.clear();
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
