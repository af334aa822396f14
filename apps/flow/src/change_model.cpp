// The part of the broker that prepares other versions of the model.
#include "broker_parts.hpp"

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

#include <nendo/flow/finger_supports.hpp>

namespace nendo::flow {

ModelVersions::ModelVersions(const deform::Mesh& model, const UndoSpace& undo,
                             const deform::BlockShape* first)
    : undo_(undo) {
  all_.push_back(
      std::make_shared<ModelVersion>(0, model, deform::BlockLayout(model.vertices), undo, first));
}

std::shared_ptr<ModelVersion> ModelVersions::find(std::uint32_t number) const noexcept {
  for (const auto& version : all_)
    if (version->number == number) return version;
  return nullptr;
}

ModelVersion& ModelVersions::add(std::unique_ptr<ModelVersion> version) {
  ++last_number_;
  all_.push_back(std::move(version));
  return *all_.back();
}

void ModelVersions::release_others(const ModelVersion& newest) {
  std::erase_if(all_, [&newest](const auto& version) {
    for (const ModelVersion* at = &newest; at != nullptr; at = at->before)
      if (at == version.get()) return false;
    return true;
  });
}

UndoSpace ModelVersions::remaining_space() const noexcept {
  if (undo_.max_bytes == 0) return {undo_.bytes, 0};
  std::size_t used = 0;
  for (const auto& version : all_)
    if (version->undo_memory) used += version->undo_memory->bytes();
  return {0, undo_.max_bytes - std::min(undo_.max_bytes, used)};
}

ModelVersion& ChangeBroker::first_model() noexcept {
  return parts_->versions.first();
}

const ModelVersion& ChangeBroker::newest_model() const noexcept {
  return *parts_->asked_model;
}

std::shared_ptr<const ModelVersion> ChangeBroker::model(std::uint32_t number) const noexcept {
  return parts_->versions.find(number);
}

bool ChangeBroker::refill_undo() {
  deform::UndoMemory* const memory = parts_->asked_model->undo_memory.get();
  return memory == nullptr || memory->refill();
}

Result<void> ChangeBroker::hold_still() {
  if (is_changing())
    return Error{Errc::failed, "the loop has yet to take another change; ask again later"};
  if (parts_->is_still)
    return Error{Errc::failed, "the loop holds still already; change or keep its model first"};
  parts_->next_change().holds_still = true;
  parts_->offer();
  return {};
}

bool ChangeBroker::is_still() {
  return !is_changing() && parts_->is_still;
}

Result<void>
ChangeBroker::change_model(PendingModel& finer,
                           const std::function<Result<void>(const ModelVersion&)>& accepts) {
  Parts& parts = *parts_;
  assert(is_still() && finer.is_of(*parts.asked_model));
  auto made = finer.finish(parts.versions.next_number(), parts.versions.remaining_space(),
                           is_played(parts.asked_rig()));
  SculptorOptions sculptor = parts.asked.options;
  const auto check = [&]() -> Result<void> {
    if (!made) return Error{made.error().code, "the model " + made.error().message};
    // A puppet's points may lie too near to each other on another version.
    if (auto fits = parts.set_model(sculptor, **made); !fits) return fits;
    return accepts ? accepts(**made) : Result<void>();
  };
  if (auto fine = check(); !fine) {
    keep_model();
    return fine;
  }
  parts.asked.options = std::move(sculptor);
  ModelVersion& version = parts.versions.add(*std::move(made));
  parts.offer_model(version, finer.change_to(version));
  return {};
}

void ChangeBroker::keep_model() {
  assert(is_still());
  parts_->offer_model(*parts_->asked_model, {parts_->asked_model->number});
}

Result<void> ChangeBroker::change_to(const Awaited& awaited) {
  ModelVersion* const version = parts_->versions.find(awaited.model).get();
  if (version == nullptr || awaited.puppet >= next_puppet())
    return Error{Errc::bad_input, "there is no such model, or no such puppet"};
  if (!awaited.settings.are_usable()) return change_settings(awaited.settings);
  if (version != parts_->asked_model) {
    if (is_changing() || parts_->is_still)
      return Error{Errc::failed, "the model is being changed; try it again"};
    parts_->offer_model(*version, {version->number});
  }
  if (awaited.puppet != newest_puppet())
    if (auto changed = change_puppet(awaited.puppet); !changed) return changed;
  return change_settings(awaited.settings);
}

/// Offers that version, which must not change until the loop has it.
void ChangeBroker::Parts::offer_model(ModelVersion& version, const ChangeModel& model) {
  next_change();
  change->model = model;
  // A kept version was tried when it was made.
  if (&version != asked_model && !model.is_new())
    static_cast<void>(set_model(asked.options, version));
  Shaping::prepare(asked, version, control_points(), change->ready);
  change->ready.puppet = asked_puppet;
  change->ready.is_new_model = model.is_new();
  if (change->log) change->log->of_other_model = space_for_shape(version);
  model_before = asked_model;
  if (&version != asked_model)
    change->ready.spare_shapes.fill({version.number, version.shape.shape()});
  asked_model = &version;
  offer();
  // Those that are not possible with this version are dropped.
  if (settings_later) static_cast<void>(change_settings(*std::exchange(settings_later, {})));
}

/// Puts the masks and the puppet's field for that version into the options. Error: the puppet's
/// points are too near to each other.
Result<void> ChangeBroker::Parts::set_model(SculptorOptions& sculptor,
                                            const ModelVersion& version) const {
  set_masks(asked_rig(), version.mesh, version.layout(), sculptor);
  return set_surface(sculptor, version);
}

/// The loop has refused the last request.
void ChangeBroker::Parts::go_back() {
  asked_model = model_before;
  if (change->settings) asked = change->before;
  static_cast<void>(set_model(asked.options, *asked_model));
}

namespace {

using Masks = std::pair<std::vector<puppet::Mask>, bool>;

Masks masks_of(const puppet::Rig* rig) {
  return rig == nullptr ? Masks() : Masks(rig->puppet().masks, rig->puppet().inverted);
}

/// Returns whether the points of both have the same field along the surface.
bool have_same_field(const puppet::Rig& one, const puppet::Rig& other) {
  const auto field = [](const puppet::Rig& of) {
    const puppet::Puppet& all = of.puppet();
    return std::tie(all.distance, all.points, all.parts, all.masks, all.inverted, of.starts());
  };
  return field(one) == field(other);
}

/// Returns what `first` would be with the control points of that puppet, or of hands, but
/// without a field along the surface. supports: of the points, or of the fingertips without images.
SculptorSetup with_control_points(SculptorSetup first, deform::Supports supports,
                                  const puppet::Rig* masks, Eigen::Index hands) {
  first.options.mirror = mirror_of(masks);
  if (first.options.mirror) supports = of_both_sides(std::move(supports), 5 * hands);
  first.options.piece_length = first.settings.piece_fraction * deform::min_radius(supports);
  first.options.deformer.supports = std::move(supports);
  first.options.surface.reset();
  return first;
}

} // namespace

KeptPuppets::KeptPuppets(SculptorSetup first, std::shared_ptr<const puppet::Rig> rig,
                         Eigen::Index hands)
    : first_(std::move(first)), first_rig_(std::move(rig)), hands_(hands), all_{first_rig_} {
  set_tip_supports();
}

void KeptPuppets::set_tip_supports() {
  if (!is_played(first_rig_.get()))
    tip_supports_ = of_one_side(first_.options.deformer.supports, 5 * hands_);
}

int KeptPuppets::hands_of(std::uint32_t number) const noexcept {
  return is_played(all_[number].get()) ? 0 : static_cast<int>(hands_);
}

Eigen::Index KeptPuppets::control_points(std::uint32_t number,
                                         const SculptorOptions& options) const noexcept {
  return control_points_of(all_[number].get(), options, hands_);
}

SculptorSetup KeptPuppets::first_with(std::uint32_t number) const {
  const auto& rig = all_[number];
  if (rig == first_rig_) return first_;
  if (!is_played(rig.get())) // since the loop began without a puppet
    return with_control_points(first_, *tip_supports_, rig.get(), hands_);
  deform::Supports supports = rig->supports();
  if (is_played(first_rig_.get())) // whose radii may have been scaled since
    supports = scaled(std::move(supports), deform::min_radius(first_.options.deformer.supports) /
                                               deform::min_radius(first_rig_->supports()));
  return with_control_points(first_, std::move(supports), rig.get(), hands_);
}

ReadyRig KeptPuppets::ready(std::uint32_t number, std::uint32_t before,
                            const SculptorOptions& options) const {
  ReadyRig ready{number, before};
  ready.tips = deform::Points::Zero(3, control_points(number, options));
  const auto& rig = all_[number];
  ready.mirror = mirror_of(rig.get());
  if (!is_played(rig.get())) return ready;
  ready.puppet.emplace(rig);
  const auto earlier = played_.find(number);
  if (earlier != played_.end()) ready.puppet->remember(earlier->second);
  const puppet::Rig* const replaced = all_[before].get();
  ready.from = is_played(replaced)
                   ? puppet::functions_before(replaced->puppet(), rig->puppet())
                   : std::vector<std::size_t>(rig->puppet().functions.size(), puppet::no_function);
  return ready;
}

void KeptPuppets::keep(std::uint32_t number, PuppetPlayer puppet) {
  played_.insert_or_assign(number, std::move(puppet));
}

void KeptPuppets::restart(const SculptorSetup& setup, std::uint32_t number) {
  played_.clear(); // no undo leads back there
  first_ = setup;
  first_rig_ = all_[number];
  set_tip_supports();
}

std::uint32_t ChangeBroker::next_puppet() const noexcept {
  return parts_->puppets.count();
}

const std::shared_ptr<const puppet::Rig>&
ChangeBroker::puppet(std::uint32_t number) const noexcept {
  return parts_->puppets[number];
}

std::uint32_t ChangeBroker::newest_puppet() const noexcept {
  return parts_->asked_puppet;
}

const puppet::Rig* ChangeBroker::first_puppet() const noexcept {
  const puppet::Rig* const rig = puppet(0).get();
  return is_played(rig) ? rig : nullptr;
}

Result<void> ChangeBroker::change_puppet(std::shared_ptr<const puppet::Rig> rig) {
  assert(rig != nullptr);
  if (is_by_hands(settings().mode) && is_played(rig.get()))
    return Error{Errc::bad_input,
                 "puppets neither press clay nor move parts; choose type 1 or 2 first"};
  parts_->puppets.add(std::move(rig));
  auto changed = change_puppet(next_puppet() - 1);
  if (!changed) parts_->puppets.remove_last();
  return changed;
}

Result<void> ChangeBroker::change_puppet(std::uint32_t number) {
  return parts_->change_puppet(number);
}

Result<void> ChangeBroker::Parts::change_puppet(std::uint32_t number) {
  take_back_done();
  if (number >= puppets.count()) return Error{Errc::bad_input, "there is no such puppet"};
  if (number == asked_puppet) return {};
  if (!is_played(puppets[number].get()) && !puppets.can_touch())
    return Error{Errc::bad_input, "hands play a puppet here, and it needs points"};
  if (is_still || (change && (change->holds_still || change->model || change->log)))
    return Error{Errc::failed, "the model or the recording is being changed; try it again"};
  auto setup = setup_with(number);
  if (!setup) return setup.error();
  next_change();
  const std::uint32_t before = change->rig ? change->rig->before : asked_puppet;
  asked = *std::move(setup);
  asked_puppet = number;
  if (change->settings) { // which were requested together with it
    const SculptorSetup first = puppets.first_with(number);
    change->before = with_settings(first, first, change->before.settings, puppets.hands_of(number),
                                   units_per_metre);
  }
  change->rig.reset();
  if (number != before) change->rig = puppets.ready(number, before, asked.options);
  make_ready();
  offer();
  return {};
}

/// Returns what `asked` would be with that puppet.
Result<SculptorSetup> ChangeBroker::Parts::setup_with(std::uint32_t puppet) const {
  const SculptorSetup first = puppets.first_with(puppet);
  const puppet::Rig* const rig = puppets[puppet].get();
  const puppet::Rig* const before = asked_rig();
  if (auto fine = check_points(rig); !fine) return fine.error();
  SculptorSetup setup =
      with_settings(first, first, asked.settings, puppets.hands_of(puppet), units_per_metre);
  setup.options.surface.reset();
  setup.options.bodies = is_played(rig) ? nullptr : bodies;
  if (masks_of(rig) == masks_of(before))
    setup.options.deformer.mask = asked.options.deformer.mask;
  else
    set_masks(rig, asked_model->mesh, asked_model->layout(), setup.options);
  if (!is_played(rig)) return setup;
  if (is_played(before) && have_same_field(*rig, *before)) {
    setup.options.surface = asked.options.surface;
    return setup;
  }
  auto surface =
      surface_for(*rig, asked_model->mesh, asked_model->layout(), setup.options.deformer);
  if (!surface) return surface.error();
  setup.options.surface = *std::move(surface);
  return setup;
}

/// Of a puppet. Changes nothing if its points are too near to each other.
Result<void> ChangeBroker::Parts::set_surface(SculptorOptions& sculptor,
                                              const ModelVersion& version) const {
  const puppet::Rig* const rig = asked_rig();
  if (!is_played(rig)) return {};
  auto surface = surface_for(*rig, version.mesh, version.layout(), sculptor.deformer);
  if (!surface) return surface.error();
  sculptor.surface = *std::move(surface);
  return {};
}

} // namespace nendo::flow
