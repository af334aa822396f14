// The part of the loop that prepares other puppets, on the thread that asks for them.

#include <nendo/flow/deform_loop.hpp>

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

#include <nendo/flow/finger_supports.hpp>
#include <nendo/flow/prepared_change.hpp>
#include <nendo/flow/rig_setup.hpp>

namespace nendo::flow {

using deform::Points;

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
  if (auto fine = check_points(rig.get(), asked_.options); !fine) return fine.error();
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
  ready.tips = Points::Zero(3, control_points(number));
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
  if (is_by_hands(asked_.settings.mode) && !can_press(rig.get()))
    return Error{Errc::bad_input,
                 "puppets neither press clay nor move parts; choose type 1 or 2 first"};
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

} // namespace nendo::flow
