#include <nendo/flow/glove_hand.hpp>

#include <algorithm>
#include <string>
#include <utility>

#include <nendo/flow/input_script.hpp>
#include <nendo/hand/pinch_closing.hpp>

namespace nendo::flow {

Result<void> check_inputs(std::span<const HandInput> inputs) {
  if (inputs.empty() || inputs.size() > max_inputs)
    return Error{Errc::bad_input, std::to_string(inputs.size()) + " inputs of a loop: use 1 to " +
                                      std::to_string(max_inputs)};
  for (auto input = inputs.begin(); input != inputs.end(); ++input)
    if (!input->layer && std::any_of(inputs.begin(), input, [&](const HandInput& before) {
          return before.side == input->side;
        }))
      return Error{Errc::bad_input,
                   "input " + std::to_string(input - inputs.begin()) + " of a loop: the " +
                       std::string(name_of(input->side)) +
                       " hand has an input before; make this a layer, or leave it out"};
  return {};
}

std::size_t count_hands(std::span<const HandInput> inputs) noexcept {
  const bool has_other = std::any_of(inputs.begin(), inputs.end(), [&](const HandInput& input) {
    return input.side != inputs.front().side;
  });
  return inputs.empty() ? 0 : 1 + static_cast<std::size_t>(has_other);
}

GloveHand::GloveHand(HandInput hand_input, const Placement& placement, bool closes)
    : input(std::move(hand_input)), slot(Placement::index_of(input.side)),
      T_stage_wrist(placement.T_stage_wrist[slot]),
      skeletons{input.skeleton(Side::left), input.skeleton(Side::right)}, calibration(input.wearer),
      filter(input.filter), closes_pinches(closes) {
  follow(input.first);
}

bool GloveHand::update(const GloveSample& sample) noexcept {
  follow(sample);
  return wrist_switch.turned_on(sample.wrist_switch, sample.arrival);
}

void GloveHand::follow(const GloveSample& sample) noexcept {
  const hand::Calibration& active = calibration.follow(sample);
  latest = input.gated ? gate.pass(sample, active) : sample;
  pose_by(active);
}

void GloveHand::pose_by(const hand::Calibration& active) noexcept {
  angles = filter.pass(hand::joint_angles(latest, active, left_out()), latest.time());
  if (closes_pinches) angles = hand::close_pinches(angles, skeleton(), latest.present, left_out());
}

void GloveHand::change_filter(const hand::FilterOptions& options, bool closes) noexcept {
  if (filter.options() == options && closes_pinches == closes) return;
  if (filter.options() != options) filter = hand::JointFilter(options);
  closes_pinches = closes;
  pose_by(calibration.of(latest.side));
}

void GloveHand::restart() noexcept {
  input.first = latest;
  if (input.wearer.adapt) input.wearer.learned = calibration.learned();
  if (const auto* stuck = calibration.stuck()) input.wearer.stuck = stuck->stuck();
  calibration = hand::ActiveCalibration(input.wearer);
  gate = {};
  filter = hand::JointFilter(filter.options());
  wrist_switch = {};
  follow(input.first);
}

} // namespace nendo::flow
