#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include <nendo/hand/joint_limits.hpp>

#include "timeline/edit.hpp"
#include "timeline/edit_parts.hpp"
#include "timeline/function_values.hpp"

namespace nendo::timeline {
namespace {

std::string short_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", number);
  return text;
}

/// A function at the time of a key.
struct AtKey {
  puppet::FunctionState state;
  double signal = 0.0;
  double value = 0.0;
  bool is_held = false; ///< the hand moves the function
  bool is_symmetric = false;
};

AtKey function_at(const Timeline& timeline, std::size_t function, double time_s) {
  AtKey found;
  play_functions(timeline, std::array{time_s}, [&](std::size_t, const PuppetMoment& moment) {
    const puppet::RigPlayer& player = moment.hands.player();
    found.state = player.state().functions[function];
    found.signal = moment.hands.signal(found.state.input);
    found.value = player.values()[function];
    found.is_held = found.state.held && moment.is_held;
    found.is_symmetric = player.state().symmetric;
  });
  return found;
}

/// The angles whose sum a signal is; none if it is the place of a tip.
std::vector<hand::Angle> angles_of(const puppet::HandSignal& input) {
  const std::size_t number = input.number();
  if (number >= hand::finger_count) {
    if (!input.is_angle()) return {};
    return {hand::angle_at(number - hand::finger_count)};
  }
  if (number == 0) return {hand::Angle::thumb_mcp_flexion, hand::Angle::thumb_ip_flexion};
  const std::size_t first = hand::index_of(hand::Angle::index_mcp_flexion) + 4 * (number - 1);
  return {hand::angle_at(first), hand::angle_at(first + 2), hand::angle_at(first + 3)};
}

/// Bends the joints together, each by the same part of the way to its limit. Returns how much of
/// `by_rad` there was room for.
double bend(hand::JointAngles& angles, const std::vector<hand::Angle>& joints, double by_rad) {
  const auto room_of = [&](hand::Angle joint) {
    const hand::JointLimit& limit = hand::limit_of(joint);
    const double room =
        by_rad > 0.0 ? limit.max_rad - angles[joint] : angles[joint] - limit.min_rad;
    return std::max(0.0, room);
  };
  double room = 0.0;
  for (const hand::Angle joint : joints)
    room += room_of(joint);
  const double part = room > 0.0 ? std::min(1.0, std::abs(by_rad) / room) : 0.0;
  for (const hand::Angle joint : joints)
    angles[joint] += std::copysign(part * room_of(joint), by_rad);
  return std::copysign(part * room, by_rad);
}

/// Brings a fingertip farther along an axis of its wrist.
Result<void> move_tip(Timeline& timeline, const KeyRef& at, const puppet::HandSignal& input,
                      double by_m) {
  const HandTrack& track = *timeline.track(at.side);
  const Key& key = track.keys[at.key];
  const Eigen::Isometry3d T_stage_wrist = key.wrist_pose();
  const auto tips = track.skeleton().pose(key.angles, T_stage_wrist).fingertip_positions();
  const Eigen::Vector3d way = by_m * input.direction();
  constexpr double near_m = 1e-3;
  const Eigen::Vector3d target_m = tips.col(input.finger()) + T_stage_wrist.linear() * way;
  const auto set = set_tip(timeline, at.side, at.key, static_cast<hand::Finger>(input.finger()),
                           target_m, near_m);
  return set ? Result<void>() : Result<void>(set.error());
}

Result<void> set_signal(Timeline& timeline, const KeyRef& at, const puppet::Function& function,
                        const AtKey& before, double by) {
  const std::vector<hand::Angle> joints = angles_of(before.state.input);
  if (joints.empty()) return move_tip(timeline, at, before.state.input, by);
  const double bent = bend(timeline.track(at.side)->keys[at.key].angles, joints, by);
  if (std::abs(bent - by) <= 1e-9) return {};
  const double reached = puppet::value_of(function, before.state.asked + bent / function.travel);
  return Error{Errc::usage, name_of_key(at.side, at.key) + ": " + before.state.input.name() +
                                " ends where " + function.name + " is " + short_text(reached) +
                                "; choose a value up to that"};
}

/// The hand that plays the function at its key of that number.
std::optional<KeyRef> played_key(const Timeline& timeline, std::size_t function, std::size_t key) {
  for (const HandTrack& track : timeline.hands) {
    if (key >= track.keys.size()) continue;
    const AtKey there = function_at(timeline, function, track.keys[key].time_s);
    if (there.state.input.side() == track.side) return KeyRef{track.side, key};
  }
  return std::nullopt;
}

Error cannot_tell(const KeyRef& at, const std::string& name, const AtKey& now) {
  const std::string where = name_of_key(at.side, at.key) + ": ";
  if (now.is_symmetric)
    return {Errc::usage, where + name +
                             " has the value of its twin, which is greater there while "
                             "one hand plays both sides; set that one"};
  return {Errc::usage, where + "the hand takes hold of " + name +
                           " there, which begins with the value that it had; choose a later key"};
}

} // namespace

Result<ValueSet> set_value(Timeline& timeline, const std::string& name, std::size_t key,
                           double value) {
  const auto refused = [](const std::string& what) { return Error{Errc::usage, what}; };
  if (!timeline.rig) return refused("there is no puppet in it, and so no function");
  const puppet::Puppet& puppet = timeline.rig->puppet();
  const auto number = puppet.function_named(name);
  if (!number)
    return refused("the puppet has no function '" + name +
                   "'; `nendo edit show --functions` lists them");
  const puppet::Function& function = puppet.functions[*number];
  if (!(value >= function.least && value <= function.most))
    return refused(name + " goes from " + short_text(function.least) + " to " +
                   short_text(function.most) + "; choose a value in between");
  const auto at = played_key(timeline, *number, key);
  if (!at) return refused("no hand that plays " + name + " has a key " + std::to_string(key));
  const double time_s = find_key(timeline, *at)->time_s;
  const AtKey before = function_at(timeline, *number, time_s);
  if (!before.is_held)
    return refused(name_of_key(at->side, at->key) + ": the hand has let go of " + name +
                   " there; choose another key");
  Timeline result = timeline;
  const double by = (puppet::asked_for(function, value) - before.state.asked) * function.travel;
  if (const auto done = set_signal(result, *at, function, before, by); !done) return done.error();
  if (const std::string wrong = complaint_about(result); !wrong.empty()) return refused(wrong);
  const AtKey now = function_at(result, *number, time_s);
  constexpr double near = 5e-3; // a tip comes only near to where it should
  if (!(std::abs(now.value - value) <= near)) return cannot_tell(*at, name, now);
  timeline = std::move(result);
  return ValueSet{*at, now.value};
}

} // namespace nendo::timeline
