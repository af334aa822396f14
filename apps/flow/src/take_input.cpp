// The part of a tick that takes commands and samples.

#include <algorithm>
#include <utility>

#include "ticker.hpp"

namespace nendo::flow {

void DeformLoop::Ticker::take_input(TickRecord& record) noexcept {
  take_commands(record.scheduled);
  take_script(record.scheduled);
  take_samples(record);
}

void DeformLoop::Ticker::take_commands(HostTime scheduled) noexcept {
  if (const auto& wire = options_.wire_time) {
    const double now_s = stats_.ticks == 0 ? 0.0 : seconds_between(first_due_, scheduled);
    const bool draws = now_s >= wire->from_s && now_s < wire->to_s;
    if (std::exchange(draws_in_time_, draws) != draws) apply(DrawWire{draws, wire->blade});
  }
  if (options_.commands == nullptr) return;
  options_.commands->drain([this](const Command& command) noexcept { apply(command); });
}

void DeformLoop::Ticker::take_script(HostTime scheduled) noexcept {
  if (options_.script == nullptr) return;
  const HostClock::duration since_first =
      stats_.ticks == 0 ? HostClock::duration::zero() : scheduled - first_due_;
  options_.script->play(since_first, [this](const InputLogEntry& entry) noexcept {
    if (const auto* taken = std::get_if<TakenSample>(&entry)) {
      if (taken->hand >= inputs_.count()) return;
      take(taken->hand, taken->sample);
      const GloveHand& hand = inputs_[taken->hand];
      if (hand.is_topmost) ++stats_.samples[hand.slot];
    } else if (const auto* command = std::get_if<Command>(&entry)) {
      apply(*command);
    }
  });
}

void DeformLoop::Ticker::take_samples(TickRecord& record) noexcept {
  HostTime newest{};
  for (std::uint8_t number = 0; number < inputs_.count(); ++number) {
    GloveHand& hand = inputs_[number];
    const std::size_t count = hand.input.ring == nullptr
                                  ? 0
                                  : hand.input.ring->drain([&](const GloveSample& sample) noexcept {
                                      take(number, sample);
                                    });
    hand.fresh = count > 0;
    if (hand.fresh) {
      if (hand.input.wrist_path)
        apply(WristMove::to(hand.input.side,
                            hand.input.wrist_path->at(to_seconds(hand.latest.device_time))));
      const HostTime arrival = hand.latest.arrival;
      newest = std::max(newest, arrival);
      record.input = record.samples == 0 ? arrival : std::min(record.input, arrival);
      record.samples += static_cast<std::uint32_t>(count);
    }
    inputs_.count_samples(number, count, record.woke, options_.silent_after, stats_);
  }
  if (options_.policy == OverrunPolicy::sample && record.samples > 0) record.scheduled = newest;
  update_switches();
}

/// Takes a sample of that input.
void DeformLoop::Ticker::take(std::uint8_t number, const GloveSample& sample) noexcept {
  GloveHand& hand = inputs_[number];
  if (options_.input_log != nullptr) options_.input_log->sample(number, sample);
  if (!hand.update(sample)) return;
  ++stats_.switch_uses[hand.slot];
  if (core_.has_clutch(hand.input.side))
    return core_.toggle_clutch(hand.input.side, inputs_.pose());
  if (options_.switch_action == SwitchAction::toggle) core_.toggle_hold();
  if (options_.switch_action == SwitchAction::commit) core_.commit_when_held();
}

void DeformLoop::Ticker::apply(const Command& command) noexcept {
  const auto* const move = std::get_if<WristMove>(&command);
  if (!is_for_loop(command) || (move != nullptr && !move->is_usable())) return;
  if (is_for_puppet(command) && core_.puppet() == nullptr) return;
  if (options_.input_log != nullptr) options_.input_log->command(command); // a Mark is only logged
  if (move != nullptr) return inputs_.move_wrist(*move);
  if (const auto* layer = std::get_if<SetLayer>(&command)) return inputs_.set_layer(*layer);
  core_.apply(command, inputs_.pose());
}

void DeformLoop::Ticker::update_switches() noexcept {
  if (options_.switch_action != SwitchAction::grab) return;
  const auto hands = inputs_.all();
  const bool on = std::any_of(hands.begin(), hands.end(), [this](const GloveHand& hand) {
    return hand.wrist_switch.is_on() && !core_.has_clutch(hand.input.side);
  });
  if (on != switch_on_) // in between, requests are heard
    core_.ask(on ? Request::grab : Request::let_go);
  switch_on_ = on;
}

} // namespace nendo::flow
