#include <algorithm>
#include <cassert>
#include <utility>

#include "ticker.hpp"

namespace nendo::flow {

HandInputs::HandInputs(std::vector<HandInput> inputs, const Placement& placement,
                       const LoopSettings& settings) {
  assert(check_inputs(inputs));
  for (HandInput& input : inputs) {
    const bool closes = closes_pinches(input.filter, settings.mode);
    hands_.emplace_back(std::move(input), placement, closes);
    GloveHand& hand = hands_.back();
    for (GloveHand& before : hands_) {
      if (&before == &hand || before.slot != hand.slot) continue;
      hand.is_lowest = false;
      before.is_topmost = false;
    }
    auto& layer = hand.input.layer;
    if (layer && hand.is_lowest && !layer->below) layer->below = hand.angles;
  }
}

void HandInputs::move_wrist(const WristMove& move) noexcept {
  for (GloveHand& hand : hands_)
    if (hand.input.side == move.side) hand.T_stage_wrist = move.pose();
}

void HandInputs::set_layer(const SetLayer& layer) noexcept {
  if (layer.input < hands_.size() && hands_[layer.input].input.layer)
    hands_[layer.input].input.layer->on = layer.on;
}

void HandInputs::advance_layers(HostTime scheduled) noexcept {
  const HostClock::duration time =
      last_due_ == HostTime{} ? HostClock::duration::zero() : scheduled - last_due_;
  last_due_ = scheduled;
  for (GloveHand& hand : hands_)
    if (hand.input.layer) hand.input.layer->advance(time);
}

void HandInputs::change_filters(const LoopSettings& settings) noexcept {
  const bool closes = closes_pinches(settings.filter, settings.mode);
  for (GloveHand& hand : hands_)
    hand.change_filter(settings.filter, closes);
}

void HandInputs::restart(LoopState& state) noexcept {
  for (std::size_t at = 0; at < hands_.size(); ++at) {
    GloveHand& hand = hands_[at];
    hand.restart();
    state.inputs[at] = {hand.input.first, hand.input.wearer.learned, hand.input.layer,
                        hand.input.wearer.stuck};
    state.placement.T_stage_wrist[hand.slot] = hand.T_stage_wrist;
  }
  last_due_ = {}; // as in a loop that begins
}

/// Returns the angles of a hand, with all layers over it.
hand::JointAngles HandInputs::angles_of(const GloveHand& lowest) const noexcept {
  hand::JointAngles angles = lowest.input.layer ? *lowest.input.layer->below : lowest.angles;
  for (const GloveHand& hand : hands_)
    if (hand.slot == lowest.slot && hand.input.layer)
      hand.input.layer->play_over(hand.angles, angles);
  return angles;
}

HandInputs::Hands HandInputs::pose() noexcept {
  Hands hands{};
  for (const GloveHand& hand : hands_) {
    if (!hand.is_lowest) continue;
    puppet::HandState& state = states_[hand.slot];
    state.angles = angles_of(hand);
    state.pose = hand.skeleton().pose(state.angles, hand.T_stage_wrist);
    state.T_world_wrist = hand.T_stage_wrist;
    hands[hand.slot] = &state;
  }
  return hands;
}

/// A hand is, if all inputs of its side are.
bool HandInputs::is_silent(std::size_t slot) const noexcept {
  return std::all_of(hands_.begin(), hands_.end(),
                     [&](const GloveHand& hand) { return hand.slot != slot || hand.silent; });
}

void HandInputs::show(const LoopStats& stats, Frame& frame) const noexcept {
  frame.layers_on = 0;
  for (std::size_t at = 0; at < hands_.size(); ++at) {
    const GloveHand& hand = hands_[at];
    if (hand.input.layer && hand.input.layer->on) frame.layers_on |= 1U << at;
    if (!hand.is_lowest) continue;
    HandFrame& shown = frame.hands[hand.slot];
    const puppet::HandState& state = states_[hand.slot];
    shown.angles = state.angles;
    shown.pose = state.pose;
    shown.swapped = hand.latest.side != hand.input.first.side;
    shown.T_stage_wrist = hand.T_stage_wrist;
    shown.present = true;
    shown.silent = is_silent(hand.slot);
    shown.samples = stats.samples[hand.slot];
    shown.left_out = hand.left_out();
  }
}

void HandInputs::count_samples(std::size_t number, std::size_t samples, HostTime now,
                               HostClock::duration silent_after, LoopStats& stats) noexcept {
  GloveHand& hand = hands_[number];
  const bool silent = now - hand.latest.arrival > silent_after;
  const bool fell_silent = silent && !std::exchange(hand.silent, silent);
  hand.silent = silent;
  if (!hand.is_topmost) return;
  if (fell_silent) ++stats.silences[hand.slot];
  stats.samples[hand.slot] += samples;
  SampleRate& rate = stats.rates[hand.slot];
  if (stats.ticks == 0) {
    rate = {0, hand.latest.arrival, hand.latest.arrival};
  } else if (hand.fresh) {
    rate.samples += samples;
    rate.last = hand.latest.arrival;
  }
  stats.spikes[hand.slot] = hand.gate.spikes();
  stats.left_out[hand.slot] = hand.left_out();
  stats.was_left_out[hand.slot].bits |= hand.left_out().bits;
  if (const auto* learned = hand.calibration.adaptation()) {
    stats.ranges[hand.slot] = learned->ranges();
    stats.range_sides[hand.slot] = learned->side().value_or(hand.input.side);
  } else if (const auto* slips = hand.calibration.slips()) {
    stats.ranges[hand.slot] = slips->ranges();
    stats.range_sides[hand.slot] = slips->side();
    stats.slips_counts[hand.slot] = slips->slips_counts();
  }
}

void HandInputs::record_latencies(HostTime done, LoopStats& stats) const noexcept {
  for (const GloveHand& hand : hands_) {
    if (!hand.fresh) continue;
    stats.end_to_end.record(done - hand.latest.arrival);
    if (hand.filter.options().kind == hand::FilterKind::off) continue;
    const hand::FilterLatency latency = hand.filter.latency();
    stats.filter_moving.record(from_seconds(latency.moving_s));
    stats.filter_worst.record(from_seconds(latency.worst_s));
  }
}

} // namespace nendo::flow
