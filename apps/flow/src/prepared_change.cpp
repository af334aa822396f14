// The part of the loop that prepares changes, on the thread that asks for them.

#include <nendo/flow/deform_loop.hpp>

#include <algorithm>
#include <cassert>
#include <utility>

#include <nendo/base/relax.hpp>
#include <nendo/flow/finger_supports.hpp>
#include <nendo/flow/prepared_change.hpp>
#include <nendo/flow/rig_setup.hpp>

namespace nendo::flow {

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

/// Nothing, if nothing can be done with the settings.
std::optional<SculptorSetup> DeformLoop::setup_for(const SculptorSetup& before,
                                                   const LoopSettings& settings) const {
  const bool presses = can_press(puppets_[asked_puppet_].get());
  if (!presses && is_by_hands(settings.mode) && settings.mode != asked_.settings.mode)
    return std::nullopt;
  SculptorSetup setup = with_settings(before, first_with(asked_puppet_), settings,
                                      hands_of(asked_puppet_), units_per_metre_);
  if (settings.mode != asked_.settings.mode &&
      !check_points(puppets_[asked_puppet_].get(), setup.options))
    return std::nullopt;
  setup.options.surface = asked_.options.surface; // others may be another version's
  setup.options.deformer.mask = asked_.options.deformer.mask;
  setup.options.bodies = presses ? bodies_ : nullptr;
  const bool same =
      settings.kernel == asked_.settings.kernel && settings.radius_m == asked_.settings.radius_m;
  if (!same && !set_surface(setup.options, *asked_model_)) return std::nullopt;
  // Along a surface, no kernel is known that keeps the volume.
  if (setup.options.is_along_surface() && settings.keep_volume > 0.0) return std::nullopt;
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
      for (const ModelVersion* at = asked_model_; at->before != nullptr; at = at->before)
        states_.back().origins.insert(states_.back().origins.begin(), at->origin);
      first_ = asked_; // from here on, as a replay that begins here
      first_rig_ = puppets_[asked_puppet_];
      if (!is_played(first_rig_.get()))
        tip_supports_ = of_one_side(first_.options.deformer.supports, 5 * hand_count());
    }
    change_.reset();
  }
  return is_offered_;
}

std::optional<LoopState> DeformLoop::take_state() {
  is_changing();
  if (states_.empty()) return std::nullopt;
  LoopState state = std::move(states_.front());
  states_.erase(states_.begin());
  return state;
}

} // namespace nendo::flow
