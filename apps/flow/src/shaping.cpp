#include <nendo/flow/shaping.hpp>

#include <algorithm>

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
      sculptor_(rest, control_points, with_memory(options.sculptor, undo_memory_.get())),
      held_(options.held), hold_wanted_(held_) {
  steps_due_.reserve(options.most_requests);
  refill_undo();
}

void Shaping::ask(Request request) noexcept {
  if (request == Request::grab) hold_wanted_ = true;
  if (request == Request::let_go) hold_wanted_ = false;
  if (request == Request::commit) commit_due_ = held_ || hold_wanted_;
  const bool steps = request == Request::undo || request == Request::redo;
  if (steps && steps_due_.size() < steps_due_.capacity()) steps_due_.push_back(request);
}

void Shaping::take_steps(const Points& tips, LoopStats& stats) noexcept {
  auto due = steps_due_.begin();
  for (; due != steps_due_.end(); ++due) {
    const bool undoes = *due == Request::undo;
    if (!undoes && sculptor_.redo_steps() == 0) continue;
    // What cannot be done now has changed nothing, and is tried again at the next tick.
    if (!is_solved(undoes ? sculptor_.undo(tips) : sculptor_.redo(tips))) break;
    ++(undoes ? stats.undos : stats.redos);
    shaped_ = false;
  }
  steps_due_.erase(steps_due_.begin(), due);
}

// Type-1 drops with an undo what was shaped since the commit that it undoes. Type-2 keeps it as a
// step of its own.
std::size_t Shaping::undo_steps() const noexcept {
  const std::size_t steps = sculptor_.undo_steps();
  if (!held_ || !shaped_) return steps;
  return sculptor_.mode() == Mode::type2 ? steps + 1 : std::max<std::size_t>(steps, 1);
}

FieldStatus Shaping::shape(const Points& tips, Frame& frame, LoopStats& stats) noexcept {
  take_steps(tips, stats);
  if (!held_ && hold_wanted_) {
    held_ = is_solved(sculptor_.grab(tips));
    if (held_) ++stats.grabs;
  }
  FieldStatus status = FieldStatus::ok;
  if (held_) {
    const bool commits = commit_due_ || !hold_wanted_; // letting go keeps what has been shaped
    status = commits ? sculptor_.finish(tips, frame.shape) : sculptor_.update(tips, frame.shape);
    frame.fields.follow(sculptor_.fields());
    frame.chain = sculptor_.report();
    count_chain(frame.chain, stats);
    const bool moves = moves_anything(frame.fields);
    shaped_ = moves || (shaped_ && sculptor_.mode() == Mode::type2); // type 1 begins at the rest
    // What cannot be committed now stays held, and is tried again at the next tick.
    if (commits && is_solved(status) && is_solved(sculptor_.commit(tips))) {
      ++stats.commits;
      commit_due_ = false;
      shaped_ = false;
      held_ = hold_wanted_;
    }
  } else {
    frame.shape.follow(sculptor_.rest());
    frame.fields.clear();
    frame.chain = {};
  }
  stats.undo_steps = sculptor_.undo_steps();
  stats.forgotten_steps = sculptor_.forgotten_steps();
  frame.commits = stats.commits;
  frame.undos = stats.undos + stats.redos;
  frame.undo_steps = undo_steps();
  frame.redo_steps = sculptor_.redo_steps();
  frame.held = held_;
  return status;
}

Points Shaping::final_shape(const Points& tips) {
  deform::BlockShape shape = sculptor_.rest();
  if (held_) sculptor_.finish(tips, shape);
  Points vertices;
  sculptor_.layout().unpack(shape, vertices);
  return vertices;
}

} // namespace nendo::flow
