// The part of the loop that takes changes: on the loop's side in the tick, and on the side of the
// thread that asks for them.

#include <nendo/flow/prepared_change.hpp>

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

#include <nendo/base/relax.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/finger_supports.hpp>
#include <nendo/flow/tips_of_hand.hpp>

namespace nendo::flow {

using deform::Points;

namespace {

/// Without its content.
deform::BlockShape room_for_shape(const ModelVersion& version) {
  return deform::BlockShape(std::vector<deform::VertexBlock>(version.layout().block_count()));
}

} // namespace

// The loop's side.

void DeformLoop::take_change() noexcept {
  if (!changes_.take(taken_)) return;
  InputLog* const log = options_.input_log;
  if (log != nullptr) {
    if (taken_->holds_still) log->command(HoldStill{});
    if (taken_->model) log->command(*taken_->model);
    // Whoever does the same in this order is refused neither: masks are not for clay.
    const bool becomes_clay = taken_->settings && taken_->settings->mode == Mode::clay;
    if (taken_->settings && !becomes_clay) log->command(ChangeSettings{*taken_->settings});
    if (taken_->rig) log->command(ChangePuppet{taken_->rig->number});
    if (becomes_clay) log->command(ChangeSettings{*taken_->settings});
  }
  if (!taken_->log || !shaping_.is_held()) return;
  // What was recorded leads to a shape that is committed, so that a replay ends with the same one.
  if (log != nullptr) log->command(Request::commit);
  shaping_.ask(Request::commit);
}

/// After the tick has made its shape.
void DeformLoop::finish_change(Frame& frame) noexcept {
  if (taken_->holds_still) {
    shaping_.hold_still(tips_, frame, stats_);
    if (rig_) std::copy(rig_->values().begin(), rig_->values().end(), still_at_.begin());
  }
  if (taken_->settings) change_filters(taken_->settings->filter);
  if (taken_->exchanges()) {
    const bool holds_on = shaping_.holds_on(taken_->ready);
    if (taken_->rig) take_rig(*taken_->rig, taken_->ready);
    if (shaping_.is_still())
      held_at_ = still_at_; // of the same size
    else if (!holds_on)
      note_hold();
    Points& other_tips = taken_->ready.tips; // where other points of the hands hold the model
    if (!rig_ && other_tips.cols() != tips_.cols()) place_tips(other_tips);
    taken_->is_refused = !shaping_.exchange(taken_->ready, tips_, frame, stats_);
    if (shaping_.sculptor().control_points() != tips_.cols()) std::swap(tips_, other_tips);
  }
  if (taken_->log) begin_anew(*taken_->log, frame);
}

/// The hands have taken hold where they are.
void DeformLoop::note_hold() noexcept {
  if (rig_) std::copy(rig_->values().begin(), rig_->values().end(), held_at_.begin());
}

/// `rig` then has what was before. If the shape is still held at the values at which the hands took
/// hold of it, these are the starts.
void DeformLoop::take_rig(ReadyRig& rig, ReadySculptor& ready) noexcept {
  if (rig.player) {
    const auto hands = hands_now();
    rig_ ? rig.player->go_on_from(*rig_, rig.from, hands) : rig.player->take_hold(hands);
    for (std::size_t at = 0; at < rig.held_at.size(); ++at)
      if (rig.from[at] < held_at_.size()) rig.held_at[at] = held_at_[rig.from[at]];
    rig.player->rig().place(rig.held_at, ready.starts);
    rig.player->write(rig.tips);
  }
  std::swap(rig_, rig.player);
  std::swap(gestures_, rig.gestures);
  std::swap(mirror_, rig.mirror);
  std::swap(held_at_, rig.held_at);
  std::swap(still_at_, rig.still_at);
  std::swap(tips_, rig.tips);
  if (!rig_) place_tips(tips_);
}

/// The angles, and so the fingertips, may jump; the shape does not, since they take hold anew.
void DeformLoop::change_filters(const hand::FilterOptions& filter) noexcept {
  for (Hand& hand : hands_) {
    if (hand.filter.options() == filter) continue;
    hand.filter = hand::JointFilter(filter);
    const auto& calibration = hand.calibration.of(hand.latest.side);
    hand.angles = hand.filter.pass(hand::joint_angles(hand.latest, calibration), hand.time());
  }
  place_tips(tips_);
}

void DeformLoop::place_tips(Points& tips) noexcept {
  if (rig_) return rig_->take_hold(hands_now()); // the points stay where they are
  Eigen::Index column = 0;
  const Eigen::Index points = points_of_hand(tips);
  for (const Hand& hand : hands_) {
    if (!hand.is_lowest) continue;
    const hand::HandPose pose = pose_of(hand);
    write_tips(pose, units_per_metre_, points, column, tips);
    column += points;
    place_body(hand, pose);
  }
  if (mirror_) mirror_half(*mirror_, tips);
}

void DeformLoop::Hand::begin_anew() noexcept {
  input.first = latest;
  const hand::RangeAdaptation* const adaptation = calibration.adaptation();
  if (adaptation != nullptr) input.wearer.learned = adaptation->learned();
  calibration = hand::ActiveCalibration(input.wearer);
  gate = {};
  filter = hand::JointFilter(filter.options());
  wrist_switch = {};
  follow(input.first);
}

void DeformLoop::begin_anew(LogChange& change, Frame& frame) noexcept {
  LoopState& state = change.state;
  for (std::size_t at = 0; at < hands_.size(); ++at) {
    Hand& hand = hands_[at];
    hand.begin_anew();
    state.inputs[at] = {hand.input.first, hand.input.wearer.learned, hand.input.layer};
    state.placement.T_stage_wrist[hand.slot] = hand.T_stage_wrist;
  }
  if (rig_) gestures_->reset(*rig_);
  place_tips(tips_);
  switch_on_ = false;
  last_due_ = {};                      // as in a loop that begins
  if (rig_) state.rig = rig_->state(); // which has room for it
  shaping_.begin_anew(tips_, change.log != nullptr, frame, stats_);
  note_hold();
  state.held = shaping_.is_held();
  const deform::BlockShape& rest = shaping_.sculptor().rest();
  if (state.shape.block_count() != rest.block_count())
    std::swap(state.shape, change.of_other_model);
  state.shape.follow(rest);
}

void DeformLoop::give_back_change() noexcept {
  if (taken_->log) options_.input_log = taken_->log->log;
  taken_ = nullptr;
  changes_.done();
}

// The side of the thread that asks.

bool DeformLoop::change_settings(const LoopSettings& settings) {
  if (!settings.are_usable()) return false;
  is_changing();
  if ((is_still_ && !is_offered_) || (change_ && change_->holds_still)) {
    settings_later_ = settings;
    return true;
  }
  if (settings == asked_.settings) return true;
  PreparedChange& change = next_change();
  if (!change.settings) change.before = asked_;
  auto wanted = setup_for(change.before, settings);
  if (!wanted) {
    offer_change(); // what there was before
    return false;
  }
  asked_ = *std::move(wanted);
  // Settings that the loop has not taken are as if nobody had asked for them.
  change.settings.reset();
  if (settings != change.before.settings) change.settings = settings;
  if (change.exchanges())
    make_ready(change);
  else
    change.ready = {};
  offer_change();
  return true;
}

void DeformLoop::make_ready(PreparedChange& change) {
  Shaping::prepare(asked_, *asked_model_, control_points(asked_puppet_), change.ready);
  change.ready.puppet = asked_puppet_;
  if (!change.rig) {
    change.ready.holds_on = false;
    return;
  }
  const puppet::Rig* const before = puppets_[change.rig->before].get();
  const puppet::Rig* const after = puppets_[asked_puppet_].get();
  change.ready.holds_on = is_played(before) && is_played(after);
  change.ready.puppet_step = kind_of_edit(before, after);
}

/// Without their layers.
Eigen::Index DeformLoop::hand_count() const noexcept {
  return std::count_if(hands_.begin(), hands_.end(),
                       [](const Hand& hand) { return hand.is_lowest; });
}

/// Of which with_settings() makes the supports; 0: they are a puppet's.
int DeformLoop::hands_of(std::uint32_t puppet) const noexcept {
  return is_played(puppets_[puppet].get()) ? 0 : static_cast<int>(hand_count());
}

/// Without their mirror images.
Eigen::Index DeformLoop::points_of_hand(const Points& tips) const noexcept {
  return tips.cols() / ((mirror_ ? 2 : 1) * hand_count());
}

Eigen::Index DeformLoop::control_points(std::uint32_t puppet) const noexcept {
  return control_points_of(puppets_[puppet].get(), asked_.options, hand_count());
}

/// Of a puppet. Changes nothing if its points are too near to each other.
Result<void> DeformLoop::set_surface(SculptorOptions& sculptor, const ModelVersion& model) const {
  const puppet::Rig* const rig = puppets_[asked_puppet_].get();
  if (!is_played(rig)) return {};
  auto surface = surface_for(*rig, model.mesh, model.layout(), sculptor.deformer);
  if (!surface) return surface.error();
  sculptor.surface = *std::move(surface);
  return {};
}

/// Does so, and puts the masks on that version, too.
Result<void> DeformLoop::set_model(SculptorOptions& sculptor, const ModelVersion& model) const {
  set_masks(puppets_[asked_puppet_].get(), model.mesh, model.layout(), sculptor);
  return set_surface(sculptor, model);
}

/// What first_ would be with that puppet.
SculptorSetup DeformLoop::first_with(std::uint32_t puppet) const {
  const auto& rig = puppets_[puppet];
  if (rig == first_rig_) return first_;
  if (!is_played(rig.get())) // since the loop began without a puppet
    return with_control_points(first_, *tip_supports_, rig.get(), hand_count());
  deform::Supports supports = rig->supports();
  if (is_played(first_rig_.get())) // whose radii people may have scaled since
    supports = scaled(std::move(supports), deform::least_radius(first_.options.deformer.supports) /
                                               deform::least_radius(first_rig_->supports()));
  return with_control_points(first_, std::move(supports), rig.get(), hand_count());
}

/// What asked_ would be with that puppet.
Result<SculptorSetup> DeformLoop::setup_with(std::uint32_t puppet) const {
  const SculptorSetup first = first_with(puppet);
  const auto& rig = puppets_[puppet];
  const auto& before = puppets_[asked_puppet_];
  SculptorSetup setup =
      with_settings(first, first, asked_.settings, hands_of(puppet), units_per_metre_);
  setup.options.surface.reset();
  setup.options.bodies = can_press(rig.get()) ? bodies_ : nullptr;
  const auto of_masks = [](const puppet::Rig* of) {
    return of == nullptr ? std::pair(std::vector<puppet::Mask>(), false)
                         : std::pair(of->puppet().masks, of->puppet().inverted);
  };
  if (of_masks(rig.get()) == of_masks(before.get()))
    setup.options.deformer.mask = asked_.options.deformer.mask;
  else
    set_masks(rig.get(), asked_model_->mesh, asked_model_->layout(), setup.options);
  if (!is_played(rig.get())) return setup;
  const auto of_field = [](const puppet::Rig& of) {
    const puppet::Puppet& all = of.puppet();
    return std::tie(all.distance, all.points, all.parts, all.masks, all.inverted, of.starts());
  };
  if (is_played(before.get()) && of_field(*rig) == of_field(*before)) {
    setup.options.surface = asked_.options.surface;
    return setup;
  }
  auto surface =
      surface_for(*rig, asked_model_->mesh, asked_model_->layout(), setup.options.deformer);
  if (!surface) return surface.error();
  setup.options.surface = *std::move(surface);
  return setup;
}

ReadyRig DeformLoop::ready_rig(std::uint32_t number, std::uint32_t before) const {
  ReadyRig ready{number, before};
  ready.tips = deform::Points::Zero(3, control_points(number));
  const auto& rig = puppets_[number];
  ready.mirror = mirror_of(rig.get());
  if (!is_played(rig.get())) return ready;
  const auto earlier = played_.find(number);
  ready.player.emplace(rig);
  ready.gestures.emplace(*rig);
  const std::size_t functions = rig->puppet().functions.size();
  if (earlier != played_.end()) {
    ready.player->remember(earlier->second.player);
    ready.held_at = earlier->second.held_at;
  }
  ready.held_at.resize(functions);
  ready.still_at.resize(functions);
  ready.from = is_played(puppets_[before].get())
                   ? puppet::functions_before(puppets_[before]->puppet(), rig->puppet())
                   : std::vector<std::size_t>(functions, puppet::no_function);
  return ready;
}

Result<void> DeformLoop::change_puppet(std::shared_ptr<const puppet::Rig> rig) {
  assert(rig != nullptr);
  if (asked_.settings.mode == Mode::clay && !can_press(rig.get()))
    return Error{Errc::bad_input,
                 "masks, symmetry and puppets do not act on clay; choose type 1 or 2 first"};
  puppets_.push_back(std::move(rig));
  auto changed = change_puppet(next_puppet() - 1);
  if (!changed) puppets_.pop_back();
  return changed;
}

Result<void> DeformLoop::change_puppet(std::uint32_t number) {
  is_changing();
  if (number >= puppets_.size()) return Error{Errc::bad_input, "there is no such puppet"};
  if (number == asked_puppet_) return {};
  if (!is_played(puppets_[number].get()) && !tip_supports_)
    return Error{Errc::bad_input, "hands play a puppet here, and it needs points"};
  if (is_still_ || (change_ && (change_->holds_still || change_->model || change_->log)))
    return Error{Errc::failed, "the model or the recording is being changed; try it again"};
  auto setup = setup_with(number);
  if (!setup) return setup.error();
  PreparedChange& change = next_change();
  const std::uint32_t before = change.rig ? change.rig->before : asked_puppet_;
  asked_ = *std::move(setup);
  asked_puppet_ = number;
  if (change.settings) { // which are asked for together with it
    const SculptorSetup first = first_with(number);
    change.before =
        with_settings(first, first, change.before.settings, hands_of(number), units_per_metre_);
  }
  change.rig.reset();
  if (number != before) change.rig = ready_rig(number, before);
  if (change.exchanges())
    make_ready(change);
  else
    change.ready = {};
  offer_change();
  return {};
}

/// Nothing, if nothing can be done with the settings.
std::optional<SculptorSetup> DeformLoop::setup_for(const SculptorSetup& before,
                                                   const LoopSettings& settings) const {
  const bool presses = can_press(puppets_[asked_puppet_].get());
  if (!presses && settings.mode == Mode::clay && settings.mode != asked_.settings.mode)
    return std::nullopt;
  SculptorSetup setup = with_settings(before, first_with(asked_puppet_), settings,
                                      hands_of(asked_puppet_), units_per_metre_);
  setup.options.surface = asked_.options.surface; // others may be another version's
  setup.options.deformer.mask = asked_.options.deformer.mask;
  setup.options.bodies = presses ? bodies_ : nullptr;
  const bool same =
      settings.kernel == asked_.settings.kernel && settings.radius_m == asked_.settings.radius_m;
  if (!same && !set_surface(setup.options, *asked_model_)) return std::nullopt;
  // Along a surface, no kernel is known that keeps the volume.
  if (setup.options.surface && settings.mode == Mode::type1 && settings.keep_volume > 0.0)
    return std::nullopt;
  return setup;
}

void DeformLoop::change_log(InputLog* log, const deform::BlockShape& like) {
  assert(!is_still_);
  PreparedChange& change = next_change();
  LogChange begins;
  begins.log = log;
  begins.state.placement.units_per_metre = units_per_metre_;
  begins.state.placement.table = bodies_->table();
  // A frame may be of a version before.
  begins.state.shape = like.block_count() == asked_model_->layout().block_count()
                           ? like
                           : room_for_shape(*asked_model_);
  if (change.model) begins.of_other_model = room_for_shape(*model_before_); // if it is refused
  begins.state.inputs.resize(hands_.size());
  begins.state.puppet = puppets_[asked_puppet_];
  if (is_played(begins.state.puppet.get()))
    begins.state.rig.functions.resize(begins.state.puppet->puppet().functions.size());
  change.log = std::move(begins);
  offer_change();
}

/// Takes the change back that the loop has not taken yet, or makes another.
PreparedChange& DeformLoop::next_change() {
  if (is_offered_ && changes_.withdraw()) is_offered_ = false;
  while (is_changing()) // the loop is in its tick
    relax();
  if (!change_) change_ = std::make_unique<PreparedChange>();
  return *change_;
}

void DeformLoop::offer_change() {
  if (change_->is_empty()) return change_.reset();
  changes_.offer(change_.get());
  is_offered_ = true;
}

bool DeformLoop::is_changing() {
  if (is_offered_ && changes_.is_done()) {
    is_offered_ = false;
    is_still_ = change_->holds_still;
    if (change_->is_refused) go_back();
    if (change_->model) free_others(*change_->model);
    if (auto& rig = change_->rig; rig && rig->player)
      played_.insert_or_assign(rig->before,
                               Played{*std::move(rig->player), std::move(rig->held_at)});
    if (change_->log) {
      played_.clear(); // no undo leads back there
      states_.push_back(std::move(change_->log->state));
      states_.back().sculptor = asked_; // nobody has asked for others since
      for (const ModelVersion* at = asked_model_->before; at != nullptr; at = at->before)
        ++states_.back().subdivisions;
      first_ = asked_; // from here on, as a replay that begins here
      first_rig_ = puppets_[asked_puppet_];
      if (!is_played(first_rig_.get()))
        tip_supports_ = of_one_side(first_.options.deformer.supports, 5 * hand_count());
    }
    change_.reset();
  }
  return is_offered_;
}

bool DeformLoop::hold_still() {
  if (is_changing() || is_still_) return false;
  next_change().holds_still = true;
  offer_change();
  return true;
}

bool DeformLoop::is_still() {
  return !is_changing() && is_still_;
}

ModelVersion* DeformLoop::version_numbered(std::uint32_t number) const noexcept {
  for (const auto& version : versions_)
    if (version->number == number) return version.get();
  return nullptr;
}

bool DeformLoop::change_model(FinerModel& finer,
                              const std::function<bool(const ModelVersion&)>& accepts) {
  assert(is_still() && finer.is_of(*asked_model_));
  versions_.push_back(finer.finish(last_number_ + 1, undo_room()));
  if (accepts && !accepts(*versions_.back())) {
    versions_.pop_back();
    keep_model();
    return false;
  }
  ++last_number_;
  offer_model(*versions_.back(), ModelSource::subdivided);
  return true;
}

void DeformLoop::keep_model() {
  assert(is_still());
  offer_model(*asked_model_, ModelSource::kept);
}

bool DeformLoop::change_to(const Awaited& awaited) {
  ModelVersion* const version = version_numbered(awaited.model);
  if (version == nullptr || !awaited.settings.are_usable() || awaited.puppet >= puppets_.size())
    return false;
  if (version != asked_model_) {
    if (is_changing() || is_still_) return false;
    offer_model(*version, ModelSource::kept);
  }
  if (awaited.puppet != asked_puppet_ && !change_puppet(awaited.puppet)) return false;
  return change_settings(awaited.settings);
}

/// Offers that version, which must not change until the loop has it.
void DeformLoop::offer_model(ModelVersion& version, ModelSource source) {
  PreparedChange& change = next_change();
  change.model = {version.number, source};
  // Points that can be solved for on one version can be on its subdivisions.
  if (&version != asked_model_) static_cast<void>(set_model(asked_.options, version));
  Shaping::prepare(asked_, version, control_points(asked_puppet_), change.ready);
  change.ready.puppet = asked_puppet_;
  change.ready.is_new_model = source == ModelSource::subdivided;
  if (change.log) change.log->of_other_model = room_for_shape(version);
  model_before_ = asked_model_;
  if (&version != asked_model_)
    change.ready.shape_room.fill({version.number, version.shape.shape()});
  asked_model_ = &version;
  offer_change();
  if (settings_later_) change_settings(*std::exchange(settings_later_, {}));
}

/// The loop has refused what was asked for last.
void DeformLoop::go_back() {
  asked_model_ = model_before_;
  if (change_->settings) asked_ = change_->before;
  static_cast<void>(set_model(asked_.options, *asked_model_));
}

/// Where a new version has taken the way that a redo would have gone, frees those of that way.
void DeformLoop::free_others(const ChangeModel& taken) {
  if (taken.source == ModelSource::kept) return;
  std::erase_if(versions_, [this](const auto& version) {
    for (const ModelVersion* at = asked_model_; at != nullptr; at = at->before)
      if (at == version.get()) return false;
    return true;
  });
}

/// What is left of the memory for undo. Memory that grows is not allocated while the loop holds
/// still.
UndoRoom DeformLoop::undo_room() const noexcept {
  std::size_t used = 0;
  for (const auto& version : versions_)
    if (version->undo_memory) used += version->undo_memory->bytes();
  const std::size_t most = options_.undo_most_bytes;
  if (most > 0) return {0, most - std::min(most, used)};
  return {options_.sculptor.deformer.undo_bytes, 0};
}

bool DeformLoop::refill_undo() {
  return asked_model_->undo_memory == nullptr || asked_model_->undo_memory->refill();
}

std::optional<LoopState> DeformLoop::take_state() {
  is_changing();
  if (states_.empty()) return std::nullopt;
  LoopState state = std::move(states_.front());
  states_.erase(states_.begin());
  return state;
}

} // namespace nendo::flow
