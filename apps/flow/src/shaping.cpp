#include <nendo/flow/shaping.hpp>

#include <algorithm>
#include <utility>

namespace nendo::flow {

using deform::FieldStatus;
using deform::Points;

namespace {

// Changes that are less than this apart are one step, with what is shaped between them.
constexpr HostClock::duration same_step_time = std::chrono::seconds(1);
// Hands that have been away from clay for this long have ended their stroke.
constexpr HostClock::duration contact_timeout = std::chrono::milliseconds(300);

void count_chain(const deform::ChainReport& chain, LoopStats& stats) noexcept {
  stats.max_links = std::max(stats.max_links, chain.links);
  stats.max_bound = std::max(stats.max_bound, chain.whole_bound);
  stats.min_determinant = std::min(stats.min_determinant, chain.min_determinant);
  if (chain.held_pairs > 0) ++stats.held_apart_ticks;
}

/// Makes a sculptor of that version of the model. Allocates.
std::unique_ptr<Sculptor> sculptor_on(ModelVersion& model, Eigen::Index control_points,
                                      SculptorOptions options) {
  if (options.needs_rings()) {
    if (!model.rings)
      model.rings = std::make_shared<const deform::VertexRings>(model.mesh, model.layout());
    options.rings = model.rings;
  }
  if (options.mode == Mode::clay) {
    if (!model.clay) model.clay = std::make_shared<const ClayModel>(model.mesh);
    options.clay = model.clay;
  }
  if (options.mode == Mode::parts) {
    if (!model.parts)
      model.parts = std::make_shared<const deform::ModelParts>(model.mesh, model.layout());
    options.parts = model.parts;
  }
  return std::make_unique<Sculptor>(model.shape, control_points, options);
}

} // namespace

Shaping::Shaping(ModelVersion& model, const SculptorSetup& setup, Eigen::Index control_points,
                 const ShapingOptions& options)
    : model_(&model), sculptor_(sculptor_on(model, control_points, setup.options)),
      still_tips_(Points::Zero(3, control_points)), changes_at_once_(options.changes_at_once),
      held_(options.held), hold_wanted_(held_), settings_(setup.settings) {
  steps_due_.reserve(options.max_requests);
}

void Shaping::ask(Request request) noexcept {
  if (request == Request::grab) hold_wanted_ = true;
  if (request == Request::release) hold_wanted_ = false;
  if (request == Request::commit) commit_due_ = held_ || hold_wanted_;
  if (request == Request::regrab) regrab_due_ = true;
  if (!goes_through_history(request)) return;
  if (steps_due_.size() < steps_due_.capacity())
    steps_due_.push_back(request);
  else
    ++refused_steps_; // many wait for a change that another thread has yet to make
}

FieldStatus Shaping::shape(const Points& tips, Frame& frame, LoopStats& stats,
                           bool completes) noexcept {
  make_space(frame);
  frame.puppet = puppet_;
  if (!is_still_) take_steps(tips, stats);
  if (!is_still_ && !awaited_ && std::exchange(regrab_due_, false) && held_) regrab(tips);
  if (!is_still_ && !held_ && hold_wanted_) {
    held_ = is_solved(sculptor_->grab(tips));
    if (held_) ++stats.grabs;
  }
  const FieldStatus status =
      held_ && !is_still_
          ? shape_by_hands(tips, frame, stats, completes || (awaited_ && changes_at_once_))
          : show_rest(frame);
  frame.held = held_;
  write_state(frame, stats);
  return status;
}

void Shaping::regrab(const Points& tips) noexcept {
  if (sculptor_->mode() == Mode::type1) {
    const FieldStatus status =
        is_pulled() ? sculptor_->undo_uncommitted(tips) : sculptor_->grab(tips);
    shaped_ = shaped_ && !is_solved(status);
    return;
  }
  sculptor_->release(false);
  in_step_ = in_step_ || shaped_;
  shaped_ = false;
  held_ = is_solved(sculptor_->continue_grab(tips)); // otherwise each tick tries again
}

FieldStatus Shaping::shape_by_hands(const Points& tips, Frame& frame, LoopStats& stats,
                                    bool completes) noexcept {
  const bool commits = commit_due_ || !hold_wanted_; // releasing keeps what has been shaped
  const FieldStatus status = commits || completes ? sculptor_->finish(tips, frame.shape)
                                                  : sculptor_->update(tips, frame.shape);
  frame.fields.follow(sculptor_->fields());
  sculptor_->write_move(frame.surface);
  frame.chain = sculptor_->report();
  count_chain(frame.chain, stats);
  if (!sculptor_->is_described_by_fields()) {
    ++shape_jumps_;
    if (frame.surface.field != 0) ++surface_moves_;
  }
  shaped_ = sculptor_->moves_anything() ||
            (shaped_ && sculptor_->mode() != Mode::type1); // type 1 begins at the rest
  write_hands(frame);
  track_clay(frame.clay, stats);
  // What cannot be committed now stays held, and is tried again at the next tick.
  if (commits && is_solved(status) && is_solved(sculptor_->commit(tips))) {
    ++stats.commits;
    commit_due_ = false;
    shaped_ = in_step_ = false;
    held_ = hold_wanted_;
  } else if (is_contact_over()) {
    end_contact(tips);
  }
  return status;
}

void Shaping::write_hands(Frame& frame) const noexcept {
  const ClayHands* const clay = sculptor_->clay();
  const PartHands* const parts = sculptor_->parts();
  frame.clay = clay == nullptr ? ClayState{} : clay->state();
  frame.parts = parts == nullptr ? PartsState{} : parts->state();
  frame.contacts.take(clay != nullptr    ? clay->contacts()
                      : parts != nullptr ? parts->contacts()
                                         : std::span<const deform::ClayContact>{});
}

void Shaping::track_clay(const ClayState& clay, LoopStats& stats) noexcept {
  if (!clay.is_clay) return;
  if (clay.touching > 0 || sculptor_->moves_anything()) touched_at_ = time_;
  if (clay.touching > 0) ++stats.touching_ticks;
  stats.max_penetration_mm = std::max(stats.max_penetration_mm, clay.penetration_mm);
  stats.clay = clay;
}

/// Returns whether a stroke of whole hands has ended. In clay, a stroke is a contact, until the
/// hands are away and the clay has come to rest. With parts, it lasts until no hand holds anything.
bool Shaping::is_contact_over() const noexcept {
  if (!shaped_ && !in_step_) return false;
  if (const PartHands* const hands = sculptor_->parts()) return !hands->state().is_held();
  return sculptor_->mode() == Mode::clay && touched_at_ && time_ - *touched_at_ >= contact_timeout;
}

void Shaping::end_contact(const Points& tips) noexcept {
  if (!is_solved(sculptor_->commit(tips))) return;
  ++strokes_ended_;
  shaped_ = in_step_ = false;
  touched_at_.reset();
}

FieldStatus Shaping::show_rest(Frame& frame) noexcept {
  frame.shape.follow(sculptor_->rest());
  frame.fields.clear();
  frame.surface.clear();
  frame.chain = {};
  write_hands(frame);
  return FieldStatus::ok;
}

void Shaping::hold_still(const Points& tips, Frame& frame, LoopStats& stats) noexcept {
  sculptor_->release(true);
  shaped_ = in_step_ = false;
  is_still_ = true;
  still_tips_ = tips;
  ++strokes_ended_;
  write_state(frame, stats);
}

void Shaping::write_state(Frame& frame, LoopStats& stats) noexcept {
  forget_redo();
  stats.undo_steps = steps_to_undo();
  stats.forgotten_steps = model_->shape.forgotten_steps();
  stats.refused_steps = refused_steps_;
  frame.commits = stats.commits;
  frame.undos = stats.undos;
  frame.rest_changes = stats.commits + strokes_ended_;
  frame.shape_jumps = shape_jumps_;
  frame.surface_moves = surface_moves_;
  frame.undo_steps = undo_steps();
  frame.redo_steps = steps_to_redo();
  frame.awaited = awaited_;
  frame.steps_due = static_cast<std::uint32_t>(steps_due_.size());
  list_steps(frame.steps);
  frame.steps.in_hand = is_in_hand();
}

/// Gives the frame space for the sculptor's fields and for the version's shape, if it has none.
void Shaping::make_space(Frame& frame) noexcept {
  if (!frame.fields.can_hold_fields_of(sculptor_->fields())) {
    for (auto& spare : spare_fields_) {
      if (!spare.can_hold_fields_of(sculptor_->fields())) continue;
      std::swap(spare, frame.fields);
      break;
    }
  }
  if (!sculptor_->has_space(frame.surface)) {
    for (auto& spare : spare_moves_) {
      if (!sculptor_->has_space(spare)) continue;
      std::swap(spare, frame.surface);
      break;
    }
  }
  if (frame.model == model_->number) return;
  for (auto& spare : spare_shapes_) {
    if (spare.model != model_->number) continue;
    std::swap(spare.shape, frame.shape);
    std::swap(spare.model, frame.model);
    return;
  }
}

void Shaping::prepare(const SculptorSetup& setup, ModelVersion& model, Eigen::Index control_points,
                      ReadySculptor& ready) {
  ready.model = &model;
  ready.sculptor = sculptor_on(model, control_points, setup.options);
  ready.settings = setup.settings;
  ready.still_tips = ready.starts = ready.tips = Points::Zero(3, control_points);
  ready.spare_fields.fill(ready.sculptor->fields());
  ready.spare_moves.fill(ready.sculptor->space_for_move());
}

bool Shaping::holds_on(const ReadySculptor& ready) const noexcept {
  return ready.holds_on && held_ && !is_still_ && sculptor_->mode() == Mode::type1 &&
         ready.sculptor->mode() == Mode::type1;
}

/// Decides what kind of exchange it is, before anything changes.
Shaping::Exchange Shaping::decide(const ReadySculptor& ready) const noexcept {
  const Awaited wanted{ready.settings, ready.model->number, ready.puppet};
  // After a commit in this tick, the first step that is due may be another one.
  if (awaited_ == wanted && target_of(steps_due_.front()) == wanted) return Exchange::awaited_step;
  if (ready.is_new_model) return Exchange::new_step;
  if (ready.model != model_) return Exchange::refused;
  const bool is_soon = exchanged_at_ && time_ - *exchanged_at_ < same_step_time;
  return is_soon && ready.puppet == puppet_ ? Exchange::same_step : Exchange::new_step;
}

bool Shaping::exchange(ReadySculptor& ready, const Points& tips, Frame& frame,
                       LoopStats& stats) noexcept {
  const Exchange kind = decide(ready);
  const bool is_change = kind == Exchange::new_step || kind == Exchange::same_step;
  const bool holds_on = this->holds_on(ready);
  const bool is_of_settings = ready.model == model_ && ready.puppet == puppet_;
  end_stroke(kind, holds_on);
  if (kind == Exchange::awaited_step) make_awaited_step(ready, stats);
  if (is_change) make_change(ready, kind);
  // Changes after another model or puppet are steps of their own.
  exchanged_at_ = is_of_settings ? std::optional(time_) : std::nullopt;
  awaited_.reset();
  // Hands that cannot grab now try again at each tick.
  if (held_) held_ = is_solved(sculptor_->continue_grab(held_points(ready, tips, holds_on)));
  if (held_ && is_change)
    sculptor_->continue_from(*ready.sculptor, ready.model == model_ ||
                                                  model_->origin->source == ModelSource::refined);
  is_still_ = false;
  if (frame.model != model_->number) {
    make_space(frame);
    show_rest(frame);
  }
  // Where the hands keep their grip, the rest shape stays, and readers of fields continue from it.
  if (!holds_on) {
    ++strokes_ended_;
    if (kind == Exchange::awaited_step) ++shape_jumps_;
  }
  ++stats.changes;
  write_state(frame, stats);
  return kind != Exchange::refused;
}

void Shaping::end_stroke(Exchange kind, bool holds_on) noexcept {
  const bool is_step = kind == Exchange::new_step;
  holds_on ? sculptor_->drop(is_step) : sculptor_->release(is_step);
  const bool joins_next = kind == Exchange::same_step || kind == Exchange::refused;
  in_step_ = joins_next && (in_step_ || (held_ && shaped_));
  shaped_ = false;
}

/// Completes the first step that is due.
void Shaping::make_awaited_step(ReadySculptor& ready, LoopStats& stats) noexcept {
  const Request step = steps_due_.front();
  step_to(step, *ready.model, in_effect());
  steps_due_.erase(steps_due_.begin());
  swap_in(ready);
  count(step, stats);
}

void Shaping::make_change(ReadySculptor& ready, Exchange kind) noexcept {
  const Awaited before = in_effect();
  if (ready.is_new_model) record_model(*ready.model, before.settings);
  swap_in(ready);
  if (puppet_ != before.puppet) record_puppet(before, ready.puppet_step);
  if (settings_ != before.settings) record_settings(before.settings, kind == Exchange::new_step);
}

/// Returns where the hands grab in exchange(), after it has swapped the sculptors.
const Points& Shaping::held_points(const ReadySculptor& ready, const Points& tips,
                                   bool holds_on) const noexcept {
  if (tips.cols() != sculptor_->control_points()) return ready.tips;
  if (holds_on) return ready.starts;
  return is_still_ ? still_tips_ : tips;
}

/// `ready` then has the previous sculptor.
void Shaping::swap_in(ReadySculptor& ready) noexcept {
  std::swap(settings_, ready.settings);
  std::swap(sculptor_, ready.sculptor);
  std::swap(spare_fields_, ready.spare_fields);
  std::swap(spare_moves_, ready.spare_moves);
  std::swap(puppet_, ready.puppet);
  if (still_tips_.cols() != ready.still_tips.cols()) std::swap(still_tips_, ready.still_tips);
  if (ready.model == model_) return;
  std::swap(model_, ready.model);
  std::swap(spare_shapes_, ready.spare_shapes);
}

void Shaping::restart(const Points& tips, bool fences, Frame& frame, LoopStats& stats) noexcept {
  sculptor_->release(true);
  shaped_ = in_step_ = commit_due_ = regrab_due_ = false;
  exchanged_at_.reset();
  touched_at_.reset();
  steps_due_.clear();
  awaited_.reset();
  if (fenced_ != nullptr) fenced_->shape.unfence();
  fenced_ = fences ? model_ : nullptr;
  if (fences) model_->shape.fence();
  const bool takes_hold = is_solved(sculptor_->grab(tips));
  held_ = hold_wanted_ = held_ && takes_hold;
  ++strokes_ended_;
  write_state(frame, stats);
}

Points Shaping::final_shape(const Points& tips) {
  deform::BlockShape shape = sculptor_->rest();
  if (held_ && !is_still_) sculptor_->finish(tips, shape);
  Points vertices;
  layout().unpack(shape, vertices);
  return vertices;
}

} // namespace nendo::flow
