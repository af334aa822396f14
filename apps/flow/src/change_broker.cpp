#include <nendo/flow/change_broker.hpp>

#include <cassert>
#include <utility>

#include <nendo/base/atomics.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/flow/setting.hpp>

#include "broker_parts.hpp"

namespace nendo::flow {
namespace {

SculptorSetup first_setup(const CoreOptions& options, const ModelVersion& version) {
  SculptorSetup setup = options.setup;
  const puppet::Rig* const rig = options.rig.get();
  if (is_played(rig)) setup.options.hold = Hold::fingertips; // its points hold
  if (!is_played(rig)) setup.options.bodies = options.bodies;
  set_masks(rig, version.mesh, version.layout(), setup.options);
  if (!is_played(rig) || setup.options.surface) return setup;
  const deform::DeformerOptions& unmasked = options.setup.options.deformer;
  if (auto surface = surface_for(*rig, version.mesh, version.layout(), unmasked))
    setup.options.surface = *std::move(surface);
  return setup;
}

/// Returns the kind of the step from one to the other: puppet, mask, or symmetry.
StepKind kind_of_edit(const puppet::Rig* before, const puppet::Rig* after) noexcept {
  if (is_played(before) || is_played(after)) return StepKind::puppet;
  return mirror_of(before) == mirror_of(after) ? StepKind::mask : StepKind::symmetry;
}

} // namespace

ChangeBroker::Parts::Parts(const deform::Mesh& model, const CoreOptions& options,
                           const deform::BlockShape* first)
    : bodies(options.bodies), inputs(options.inputs), units_per_metre(options.units_per_metre),
      versions(model, {options.setup.options.deformer.undo_bytes, options.undo_max_bytes}, first),
      asked(first_setup(options, versions.first())),
      puppets(asked, options.rig, static_cast<Eigen::Index>(options.hands.size())),
      asked_model(&versions.first()) {
  for (const auto& rig : options.more_rigs)
    puppets.add(rig);
}

ChangeBroker::ChangeBroker(const deform::Mesh& model, const CoreOptions& options,
                           const deform::BlockShape* first)
    : parts_(std::make_unique<Parts>(model, options, first)) {}

ChangeBroker::~ChangeBroker() = default;

JobOffer<PreparedChange*>& ChangeBroker::offers() noexcept {
  return parts_->offers;
}

const SculptorSetup& ChangeBroker::setup() const noexcept {
  return parts_->asked;
}

bool ChangeBroker::is_changing() {
  return parts_->take_back_done();
}

Result<void> ChangeBroker::change_settings(const LoopSettings& settings) {
  return parts_->change_settings(settings);
}

Result<void> ChangeBroker::Parts::change_settings(const LoopSettings& settings) {
  if (auto fine = check_ranges(settings); !fine) return fine;
  take_back_done();
  if ((is_still && !is_offered) || (change && change->holds_still)) {
    settings_later = settings;
    return {};
  }
  if (settings == asked.settings) return {};
  next_change();
  if (!change->settings) change->before = asked;
  auto wanted = setup_for(change->before, settings);
  if (!wanted) {
    offer(); // what there was before
    return wanted.error();
  }
  asked = *std::move(wanted);
  // Settings that the loop has not taken count as not requested.
  change->settings.reset();
  if (settings != change->before.settings) change->settings = settings;
  make_ready();
  offer();
  return {};
}

/// Makes the sculptor for the change.
void ChangeBroker::Parts::make_ready() {
  if (!change->exchanges()) {
    change->ready = {};
    return;
  }
  Shaping::prepare(asked, *asked_model, control_points(), change->ready);
  change->ready.puppet = asked_puppet;
  if (!change->rig) {
    change->ready.holds_on = false;
    return;
  }
  const puppet::Rig* const before = puppets[change->rig->before].get();
  change->ready.holds_on = is_played(before) && is_played(asked_rig());
  change->ready.puppet_step = kind_of_edit(before, asked_rig());
}

/// A mode that the loop has already continues, with any puppet and any number of points.
Result<SculptorSetup> ChangeBroker::Parts::setup_for(const SculptorSetup& before,
                                                     const LoopSettings& settings) const {
  const puppet::Rig* const rig = asked_rig();
  SculptorSetup setup = with_settings(before, puppets.first_with(asked_puppet), settings,
                                      puppets.hands_of(asked_puppet), units_per_metre);
  setup.options.surface = asked.options.surface; // others may be another version's
  setup.options.deformer.mask = asked.options.deformer.mask;
  setup.options.bodies = is_played(rig) ? nullptr : bodies;
  const bool is_other_mode = settings.mode != asked.settings.mode;
  LoopSettings judged = settings;
  if (!is_other_mode) judged.mode = Mode::type1;
  const Played played = setup.options.surface ? Played::along_surface
                        : is_played(rig)      ? Played::through_air
                                              : Played::nothing;
  if (auto fine = compatible(judged, played); !fine) return fine.error();
  if (is_other_mode)
    if (auto fine = check_points(rig); !fine) return fine.error();
  const bool same =
      settings.kernel == asked.settings.kernel && settings.radius_m == asked.settings.radius_m;
  if (!same)
    if (auto fine = set_surface(setup.options, *asked_model); !fine) return fine.error();
  return setup;
}

void ChangeBroker::change_log(InputLog* log, const deform::BlockShape& like) {
  Parts& parts = *parts_;
  assert(!parts.is_still);
  PreparedChange& change = parts.next_change();
  LogChange begins;
  begins.log = log;
  begins.state.placement.units_per_metre = parts.units_per_metre;
  begins.state.placement.table = parts.bodies->table();
  // A frame may be of an earlier version.
  begins.state.shape = like.block_count() == parts.asked_model->layout().block_count()
                           ? like
                           : space_for_shape(*parts.asked_model);
  if (change.model)
    begins.of_other_model = space_for_shape(*parts.model_before); // if it is refused
  begins.state.inputs.resize(parts.inputs);
  begins.state.puppet = parts.puppets[parts.asked_puppet];
  if (is_played(begins.state.puppet.get()))
    begins.state.rig.functions.resize(begins.state.puppet->puppet().functions.size());
  change.log = std::move(begins);
  parts.offer();
}

std::optional<LoopState> ChangeBroker::take_state() {
  is_changing();
  std::vector<LoopState>& states = parts_->states;
  if (states.empty()) return std::nullopt;
  LoopState state = std::move(states.front());
  states.erase(states.begin());
  return state;
}

/// Undoes the change that the loop has not taken yet, or makes another.
PreparedChange& ChangeBroker::Parts::next_change() {
  if (is_offered && offers.withdraw()) is_offered = false;
  while (take_back_done()) // the loop is in its tick
    relax();
  if (!change) change = std::make_unique<PreparedChange>();
  return *change;
}

void ChangeBroker::Parts::offer() {
  if (change->is_empty()) return change.reset();
  offers.offer(change.get());
  is_offered = true;
}

/// Ends a change that the loop has taken. Returns true if the loop has yet to take one.
bool ChangeBroker::Parts::take_back_done() {
  if (!is_offered || !offers.is_done()) return is_offered;
  is_offered = false;
  is_still = change->holds_still;
  if (change->is_refused) go_back();
  if (change->model && change->model->is_new()) versions.release_others(*asked_model);
  if (auto& rig = change->rig; rig && rig->puppet)
    puppets.keep(rig->before, *std::move(rig->puppet));
  if (change->log) end_log();
  change.reset();
  return false;
}

/// From here on, the loop is as one that begins here.
void ChangeBroker::Parts::end_log() {
  states.push_back(std::move(change->log->state));
  LoopState& state = states.back();
  state.sculptor = asked; // no others were requested since
  for (const ModelVersion* at = asked_model; at->before != nullptr; at = at->before)
    state.origins.insert(state.origins.begin(), at->origin);
  puppets.restart(asked, asked_puppet);
}

} // namespace nendo::flow
