#include "ticker.hpp"
#include <nendo/flow/hand_input.hpp>

#include <algorithm>
#include <cassert>
#include <string>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/flow/input_script.hpp>
#include <nendo/hand/angle.hpp>
#include <nendo/hand/joints.hpp>
#include <nendo/hand/pinch_closing.hpp>

namespace nendo::flow {

using hand::Angle;

std::optional<AngleSet> angles_named(std::string_view part) noexcept {
  AngleSet set;
  for (std::size_t at = 0; at < hand::angle_count; ++at) {
    const std::string_view name = name_of(hand::angle_at(at));
    // A finger's or the wrist's name begins the names of its angles; the palm has one.
    const bool is_part = name.substr(0, name.find('_')) == part;
    if (is_part || name == part) set.bits |= 1U << at;
  }
  if (set.is_empty()) return std::nullopt;
  return set;
}

std::optional<std::array<AngleSet, 2>> parse_layer(std::string_view text) noexcept {
  std::array<AngleSet, 2> hands{};
  for (ItemReader items(text, ','); !items.has_ended();) {
    std::string_view part = items.next();
    const bool is_whole = part.find('.') == std::string_view::npos;
    const auto side = side_named(cut(part, '.'));
    if (!side) return std::nullopt;
    const auto angles = is_whole ? std::optional(AngleSet::all()) : angles_named(part);
    if (!angles) return std::nullopt;
    hands[Placement::index_of(*side)].bits |= angles->bits;
  }
  return hands;
}

std::string in_words(Side side, AngleSet angles) {
  const std::string hand(name_of(side));
  if (angles == AngleSet::all()) return hand;
  std::string words;
  const auto add = [&](std::string_view part) {
    words += (words.empty() ? "" : ",") + hand + "." + std::string(part);
  };
  for (std::size_t at = 0; at < hand::angle_count; ++at) {
    if (!angles.has(hand::angle_at(at))) continue;
    const std::string_view name = name_of(hand::angle_at(at));
    const std::string_view part = name.substr(0, name.find('_'));
    const auto whole = angles_named(part);
    const bool has_whole = whole && (angles.bits & whole->bits) == whole->bits;
    add(has_whole ? part : name);
    if (has_whole) angles.bits &= ~whole->bits;
  }
  return words;
}

void Layer::advance(HostClock::duration time) noexcept {
  time = std::clamp(time, HostClock::duration::zero(), longest_step);
  const double step = to_seconds(time) / to_seconds(blend_time);
  weight = std::clamp(weight + (on ? step : -step), 0.0, 1.0);
}

void Layer::play_over(const hand::JointAngles& own, hand::JointAngles& angles) const noexcept {
  if (!(weight > 0.0)) return;
  const double eased = weight * weight * (3.0 - 2.0 * weight); // without a jump of the speed
  for (std::size_t at = 0; at < hand::angle_count; ++at) {
    const Angle angle = hand::angle_at(at);
    if (!joints.has(angle)) continue;
    angles[angle] =
        weight < 1.0 ? angles[angle] + eased * (own[angle] - angles[angle]) : own[angle];
  }
}

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

HandInputs::HandInputs(std::vector<HandInput> inputs, const Placement& placement,
                       const LoopSettings& settings)
    : wrists_(inputs, placement) {
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
  wrists_.recentre(move.side, move.pose());
  for (GloveHand& hand : hands_)
    if (hand.input.side == move.side) hand.T_stage_wrist = move.pose();
}

void HandInputs::follow_trackers() noexcept {
  for (GloveHand& hand : hands_)
    if (wrists_.has(hand.input.side)) hand.T_stage_wrist = wrists_.T_stage_wrist(hand.input.side);
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
  wrists_.restart();
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
  if (wrists_.is_on_hand(lowest.input.side))
    angles[Angle::wrist_pitch] = angles[Angle::wrist_yaw] = 0.0;
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
    HandFrame& shown = frame.hands[hand.slot];
    if (hand.is_topmost) shown.newest_sample = hand.latest.arrival;
    if (!hand.is_lowest) continue;
    const puppet::HandState& state = states_[hand.slot];
    shown.angles = state.angles;
    shown.pose = state.pose;
    shown.swapped = hand.latest.side != hand.input.first.side;
    shown.T_stage_wrist = hand.T_stage_wrist;
    wrists_.show(hand.input.side, shown);
    shown.present = true;
    shown.silent = is_silent(hand.slot);
    shown.samples = stats.samples[hand.slot];
    shown.sensors = hand.latest.present;
    shown.left_out = hand.left_out();
    shown.wrist_switch = hand.latest.wrist_switch;
    shown.sampled = hand.latest.time();
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
  wrists_.record_latencies(done, stats);
  for (const GloveHand& hand : hands_) {
    if (!hand.fresh) continue;
    stats.end_to_end.record(done - hand.latest.arrival);
    if (hand.filter.options().kind == hand::FilterKind::off) continue;
    const hand::FilterLatency latency = hand.filter.latency();
    stats.filter_moving.record(from_seconds(latency.moving_s));
    stats.filter_worst.record(from_seconds(latency.worst_s));
  }
}

void DeformLoop::Ticker::take_input(TickRecord& record) noexcept {
  inputs_.wrists().begin_tick();
  take_commands(record.scheduled);
  take_script(record.scheduled);
  take_poses(record.woke);
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
    if (const auto* pose = std::get_if<TakenPose>(&entry)) {
      take(pose->side, pose->pose);
    } else if (const auto* sample = std::get_if<TakenSample>(&entry)) {
      if (sample->hand >= inputs_.count()) return;
      take(sample->hand, sample->sample);
      const GloveHand& hand = inputs_[sample->hand];
      if (hand.is_topmost) ++stats_.samples[hand.slot];
    } else if (const auto* command = std::get_if<Command>(&entry)) {
      apply(*command);
    }
  });
}

/// The wrists move before the samples are taken, whose switches may grab the model.
void DeformLoop::Ticker::take_poses(HostTime woke) noexcept {
  inputs_.wrists().drain([this](Side side, const PoseSample& pose) noexcept {
    if (options_.input_log != nullptr) options_.input_log->pose(side, pose);
  });
  if (inputs_.wrists().advance(woke, stats_)) core_.ask(Request::release);
  inputs_.follow_trackers();
}

void DeformLoop::Ticker::take(Side side, const PoseSample& pose) noexcept {
  if (options_.input_log != nullptr) options_.input_log->pose(side, pose);
  inputs_.wrists().take(side, pose);
}

void DeformLoop::Ticker::take_samples(TickRecord& record) noexcept {
  HostTime newest{};
  for (std::size_t number = 0; number < inputs_.count(); ++number) {
    GloveHand& hand = inputs_[number];
    const std::size_t count = hand.input.ring == nullptr
                                  ? 0
                                  : hand.input.ring->drain([&](const GloveSample& sample) noexcept {
                                      take(static_cast<std::uint8_t>(number), sample);
                                    });
    hand.fresh = count > 0;
    if (hand.fresh) {
      if (hand.input.wrist_path && !inputs_.wrists().has(hand.input.side))
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
  if (std::holds_alternative<Recentre>(command)) return inputs_.wrists().recentre_all();
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
    core_.ask(on ? Request::grab : Request::release);
  switch_on_ = on;
}

} // namespace nendo::flow
