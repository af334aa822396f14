#include <nendo/puppet/gesture_clutch.hpp>

#include <algorithm>
#include <chrono>

namespace nendo::puppet {
namespace {

constexpr HostClock::duration moments_apart = std::chrono::milliseconds(20); // moments of the ring
constexpr double nearly_open = 0.03;             // of the way that a closing hand goes
constexpr double still_rad = from_degrees(10.0); // fingers at rest tremble by less
constexpr double still_m = 0.004;

double smooth(double part) noexcept {
  return part * part * (3.0 - 2.0 * part);
}

} // namespace

double gesture_strength(ClutchTrigger means, const HandState& hand) noexcept {
  if (means == ClutchTrigger::fist) {
    double least = hand.angles.fingers.front().flexion_rad();
    for (const hand::FingerAngles& finger : hand.angles.fingers)
      least = std::min(least, finger.flexion_rad());
    return least;
  }
  if (means != ClutchTrigger::pinch) return 0.0;
  const auto tips = hand.pose.fingertip_positions();
  return -(tips.col(0) - tips.col(1)).norm();
}

GestureClutch::GestureClutch(const Rig& rig) : options_(rig.puppet().clutch) {
  const std::size_t functions = rig.puppet().functions.size();
  for (Watch& watch : watches_) {
    watch.kept.resize(functions);
    for (Moment& moment : watch.moments)
      moment.asked.resize(functions);
  }
}

double GestureClutch::bound(ClutchTrigger means) const noexcept {
  return means == ClutchTrigger::fist ? from_degrees(options_.fist_deg) : -options_.pinch_m;
}

void GestureClutch::watch(RigPlayer& player, const RigPlayer::Hands& hands,
                          HostTime time) noexcept {
  for (const Side side : {Side::left, Side::right})
    look(player, side, hands, time);
}

void GestureClutch::reset(RigPlayer& player) noexcept {
  for (const Side side : {Side::left, Side::right}) {
    Watch& watch = watches_[static_cast<std::size_t>(side)];
    watch.state = State::unknown;
    watch.ramp = 0.0;
    watch.count = 0;
    player.set_kept(side, 0.0, {});
  }
}

void GestureClutch::look(RigPlayer& player, Side side, const RigPlayer::Hands& hands,
                         HostTime time) noexcept {
  const auto slot = static_cast<std::size_t>(side);
  const ClutchTrigger means = options_.means[slot];
  if (hands[slot] == nullptr || (means != ClutchTrigger::fist && means != ClutchTrigger::pinch))
    return;
  Watch& watch = watches_[slot];
  const double strength = gesture_strength(means, *hands[slot]);
  const double passed_s = watch.state == State::unknown ? 0.0 : to_seconds(time - watch.last);
  watch.last = time;
  advance(watch, player, side, hands, strength);
  const double step = passed_s / ease_s;
  watch.ramp = std::clamp(watch.ramp + (watch.state == State::made ? step : -step), 0.0, 1.0);
  if (player.has_released(side)) watch.ramp = 0.0; // nothing is followed, and nothing to be kept
  player.set_kept(side, smooth(watch.ramp), watch.kept);
  watch.note(player, strength, watch.ramp == 0.0);
}

/// Goes from a state to the next one.
void GestureClutch::advance(Watch& watch, RigPlayer& player, Side side,
                            const RigPlayer::Hands& hands, double strength) noexcept {
  const ClutchTrigger means = options_.means[static_cast<std::size_t>(side)];
  const double ends_at = means == ClutchTrigger::fist ? fist_ends_at : pinch_ends_at;
  const bool begins = strength >= bound(means);
  const bool ends = strength < ends_at * bound(means);
  const bool has_released = player.has_released(side);
  switch (watch.state) {
  case State::unknown:
    watch.go_to(ends ? State::open : State::done);
    break;
  case State::open:
    if (!begins) break;
    if (watch.ramp == 0.0) watch.look_back(player, strength);
    watch.go_to(State::made);
    break;
  case State::made:
    if (ends) watch.go_to(State::open);
    if (ends || watch.lasted_s() < options_.held_s) break;
    if (!has_released) player.toggle_clutch(side, hands);
    watch.go_to(has_released ? State::taking : State::done);
    break;
  case State::done:
    if (ends) watch.go_to(State::open);
    break;
  case State::taking:
    if (ends) watch.go_to(State::opening);
    break;
  case State::opening:
    if (begins) watch.go_to(State::taking);
    if (begins || !rests(watch, means, strength)) break;
    if (has_released) player.toggle_clutch(side, hands);
    watch.go_to(State::open);
    break;
  }
}

/// Finds the values that the functions had before the hand began to close: at the latest moment
/// when it was nearly as open as it was at most.
void GestureClutch::Watch::look_back(const RigPlayer& player, double strength) noexcept {
  double open = strength;
  const auto each_followed = [&](const auto& visit) {
    each_since(last - from_seconds(look_back_s), [&](const Moment& moment) {
      if (moment.followed) visit(moment);
    });
  };
  each_followed([&](const Moment& moment) { open = std::min(open, moment.strength); });
  for (std::size_t at = 0; at < kept.size(); ++at)
    kept[at] = player.asked(at);
  bool is_found = false;
  each_followed([&](const Moment& moment) {
    if (is_found || moment.strength > open + nearly_open * (strength - open)) return;
    is_found = true;
    std::ranges::copy(moment.asked, kept.begin());
  });
}

void GestureClutch::Watch::note(const RigPlayer& player, double strength, bool followed) noexcept {
  if (count > 0 && last - moments[(count - 1) % moments.size()].time < moments_apart) return;
  Moment& moment = moments[count++ % moments.size()];
  moment.time = last;
  moment.strength = strength;
  moment.followed = followed;
  for (std::size_t at = 0; at < moment.asked.size(); ++at)
    moment.asked[at] = player.asked(at);
}

bool GestureClutch::rests(const Watch& watch, ClutchTrigger means, double strength) const noexcept {
  if (watch.lasted_s() < rest_s) return false;
  double least = strength, most = strength;
  watch.each_since(watch.last - from_seconds(rest_s), [&](const Moment& moment) {
    least = std::min(least, moment.strength);
    most = std::max(most, moment.strength);
  });
  return most - least < (means == ClutchTrigger::fist ? still_rad : still_m) ||
         watch.lasted_s() >= max_rest_s;
}

} // namespace nendo::puppet
