// The part of the broker that prepares other puppets.

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

#include <nendo/flow/finger_supports.hpp>
#include <nendo/flow/rig_setup.hpp>

#include "broker_parts.hpp"

namespace nendo::flow {

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
