#include "kept_puppets.hpp"

#include <utility>

#include <nendo/flow/finger_supports.hpp>
#include <nendo/flow/rig_setup.hpp>

namespace nendo::flow {

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
  if (is_played(first_rig_.get())) // whose radii people may have scaled since
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

void KeptPuppets::begin_anew(const SculptorSetup& setup, std::uint32_t number) {
  played_.clear(); // no undo leads back there
  first_ = setup;
  first_rig_ = all_[number];
  set_tip_supports();
}

} // namespace nendo::flow
