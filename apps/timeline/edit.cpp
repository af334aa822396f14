#include "timeline/edit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include <nendo/hand/inverse_kinematics.hpp>
#include <nendo/hand/joint_limits.hpp>

#include "timeline/hand_curve.hpp"

namespace nendo::timeline {
namespace {

Error refused(const std::string& what) {
  return {Errc::usage, what};
}

std::string seconds_text(double seconds) {
  std::string text = std::to_string(seconds);
  text.erase(std::min(text.find_last_not_of('0') + 1, text.size()));
  if (text.ends_with('.')) text.pop_back();
  return text + " s";
}

auto place_of(std::vector<Key>& keys, double time_s) {
  return std::ranges::lower_bound(keys, time_s, {}, &Key::time_s);
}

Result<void> check_place(const Timeline& timeline, std::vector<Key>& keys, double to_s) {
  if (!(to_s >= 0.0 && to_s <= timeline.duration_s))
    return refused("the timeline lasts from 0 to " + seconds_text(timeline.duration_s) +
                   "; choose a time in it");
  const auto place = place_of(keys, to_s);
  if (place == keys.end() || place->time_s != to_s) return {};
  return refused("key " + std::to_string(place - keys.begin()) + " is at " + seconds_text(to_s) +
                 " already; choose another time, or delete that one first");
}

bool is_fraction(double factor) {
  return factor >= 0.0 && factor <= 1.0;
}

// Turned the shorter way.
Key between(const Key& one, const Key& other, double factor) {
  Key key = one;
  for (std::size_t at = 0; at < hand::angle_count; ++at) {
    double& angle = key.angles[hand::angle_at(at)];
    angle += factor * (other.angles[hand::angle_at(at)] - angle);
  }
  key.wrist_m += factor * (other.wrist_m - one.wrist_m);
  key.wrist_turn = one.wrist_turn.normalized().slerp(factor, other.wrist_turn.normalized());
  return key;
}

// Of all keys, in order and without the same twice. Motion towards a key after the end continues
// up to the end, which then is a key's time.
std::vector<double> times_of(const std::vector<Key>& one, const std::vector<Key>& other,
                             double end_s) {
  std::vector<double> times;
  for (const auto* keys : {&one, &other})
    for (const Key& key : *keys)
      times.push_back(std::min(key.time_s, end_s));
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// Errors: usage if there is no such hand, or if the hand has no such key.
Result<HandTrack*> track_of(Timeline& timeline, Side side) {
  if (HandTrack* track = timeline.track(side)) return track;
  return refused("there is no " + std::string(name_of(side)) + " hand in it");
}

Result<HandTrack*> track_with_key(Timeline& timeline, Side side, std::size_t key) {
  auto track = track_of(timeline, side);
  if (!track || key < (*track)->keys.size()) return track;
  return refused("the " + std::string(name_of(side)) + " hand has no key " + std::to_string(key) +
                 "; its keys are 0 to " + std::to_string((*track)->keys.size() - 1));
}

std::string name_of_key(Side side, std::size_t key) {
  return std::string(name_of(side)) + " hand, key " + std::to_string(key);
}

void mirror_key(Key& key, double plane_x_m) {
  key.wrist_m.x() = 2.0 * plane_x_m - key.wrist_m.x();
  // The turn seen in a mirror whose hand is mirrored: about x as before, about y and z the
  // other way.
  key.wrist_turn.y() = -key.wrist_turn.y();
  key.wrist_turn.z() = -key.wrist_turn.z();
}

std::size_t twin_number(const puppet::Puppet& puppet, std::size_t function) {
  const std::string& name = puppet.functions[function].name;
  return puppet.function_named(puppet::twin_of(name)).value_or(function);
}

/// Twins change their places, and each function listens to the other hand.
void mirror_roles(Timeline& timeline) {
  const puppet::Puppet& puppet = timeline.rig->puppet();
  const std::vector<puppet::FunctionState> before = timeline.rig_state.functions;
  for (std::size_t at = 0; at < before.size(); ++at)
    timeline.rig_state.functions[twin_number(puppet, at)] = {
        before[at].asked, before[at].input.mirrored(), before[at].held};
  for (Event& event : timeline.events) {
    if (auto* const clutch = std::get_if<flow::SetClutch>(&event.command))
      clutch->side = opposite(clutch->side);
    if (auto* const role = std::get_if<flow::SetRole>(&event.command))
      *role = {static_cast<std::uint16_t>(twin_number(puppet, role->function)),
               role->input.mirrored()};
  }
}

/// plane_x: model units.
std::shared_ptr<const puppet::Rig> mirrored_masks(const puppet::Rig& masks, double plane_x) {
  puppet::Puppet puppet = masks.puppet();
  if (puppet.mirrors) puppet.mirror_at = 2.0 * plane_x - puppet.mirror_at;
  for (puppet::Mask& mask : puppet.masks)
    mask.at.x() = 2.0 * plane_x - mask.at.x();
  puppet.text = puppet::text_of(puppet);
  return std::make_shared<const puppet::Rig>(std::move(puppet), masks.starts());
}

} // namespace

double time_near_end(const Timeline& timeline, Side side, double time_s,
                     std::optional<std::size_t> moved) {
  const double end_s = timeline.duration_s;
  const double tick_s = 1.0 / timeline.rate_hz;
  const HandTrack* track = timeline.track(side);
  if (track == nullptr || !(time_s > end_s && time_s <= end_s + tick_s)) return time_s;
  for (std::size_t at = 0; at < track->keys.size(); ++at)
    if (track->keys[at].time_s == end_s && at != moved) return std::max(0.0, end_s - tick_s / 2.0);
  return end_s;
}

Result<void> move_key(Timeline& timeline, Side side, std::size_t key, double to_s) {
  auto track = track_with_key(timeline, side, key);
  if (!track) return track.error();
  std::vector<Key> keys = (*track)->keys;
  Key moved = keys[key];
  keys.erase(keys.begin() + static_cast<std::ptrdiff_t>(key));
  if (auto fine = check_place(timeline, keys, to_s); !fine) return fine;
  moved.time_s = to_s;
  keys.insert(place_of(keys, to_s), moved);
  (*track)->keys = std::move(keys);
  return {};
}

Result<void> copy_key(Timeline& timeline, Side side, std::size_t key, double to_s) {
  auto track = track_with_key(timeline, side, key);
  if (!track) return track.error();
  std::vector<Key>& keys = (*track)->keys;
  if (auto fine = check_place(timeline, keys, to_s); !fine) return fine;
  Key copy = keys[key];
  copy.time_s = to_s;
  keys.insert(place_of(keys, to_s), copy);
  return {};
}

Result<void> delete_key(Timeline& timeline, Side side, std::size_t key) {
  auto track = track_with_key(timeline, side, key);
  if (!track) return track.error();
  if ((*track)->keys.size() == 1) return refused("a hand needs one key at least; this is its last");
  (*track)->keys.erase((*track)->keys.begin() + static_cast<std::ptrdiff_t>(key));
  return {};
}

Result<void> add_key(Timeline& timeline, Side side, double at_s) {
  auto track = track_of(timeline, side);
  if (!track) return track.error();
  std::vector<Key>& keys = (*track)->keys;
  if (auto fine = check_place(timeline, keys, at_s); !fine) return fine;
  keys.insert(place_of(keys, at_s), HandCurve(keys).at(at_s));
  return {};
}

Result<void> retime(Timeline& timeline, double scale, double from_s, double to_s) {
  if (!(scale >= 1e-3 && scale <= 1e3)) return refused("a scale must lie within 0.001 and 1000");
  to_s = std::min(to_s, timeline.duration_s);
  if (!(from_s >= 0.0 && from_s < to_s))
    return refused("the range must be a part of the timeline, which lasts from 0 to " +
                   seconds_text(timeline.duration_s));
  const auto retimed = [&](double time_s) {
    if (time_s <= from_s) return time_s;
    if (time_s <= to_s) return from_s + scale * (time_s - from_s);
    return from_s + scale * (to_s - from_s) + (time_s - to_s);
  };
  Timeline result = timeline;
  result.duration_s = retimed(timeline.duration_s);
  for (auto& hand : result.hands)
    for (Key& key : hand.keys)
      key.time_s = retimed(key.time_s);
  for (Event& event : result.events)
    event.time_s = retimed(event.time_s);
  if (std::string wrong = complaint_about(result); !wrong.empty()) return refused(wrong);
  timeline = std::move(result);
  return {};
}

Result<void> blend_key(Timeline& timeline, Side side, std::size_t key, double factor) {
  auto track = track_with_key(timeline, side, key);
  if (!track) return track.error();
  if (!is_fraction(factor)) return refused("a factor must lie within 0 and 1");
  std::vector<Key>& keys = (*track)->keys;
  if (key == 0 || key + 1 == keys.size())
    return refused(name_of_key(side, key) + " is at an end, and has a neighbour on one side only");
  std::vector<Key> others = keys;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(key));
  if (factor > 0.0)
    keys[key] = between(keys[key], HandCurve(std::move(others)).at(keys[key].time_s), factor);
  return {};
}

Result<void> blend(Timeline& one, const Timeline& other, double factor) {
  if (!is_fraction(factor)) return refused("a factor must lie within 0 and 1");
  Timeline result = one;
  bool any = false;
  for (HandTrack& hand : result.hands) {
    const HandTrack* partner = other.track(hand.side);
    if (partner == nullptr) continue;
    any = true;
    if (factor == 0.0) continue;
    const std::vector<double> times = times_of(hand.keys, partner->keys, one.duration_s);
    if (times.size() > max_keys) return refused("together they have too many keys");
    const HandCurve from(hand.keys);
    const HandCurve to(partner->keys);
    hand.keys.clear();
    for (const double time_s : times)
      hand.keys.push_back(between(from.at(time_s), to.at(time_s), factor));
  }
  if (!any) return refused("they have no hand in common");
  if (std::string wrong = complaint_about(result); !wrong.empty()) return refused(wrong);
  one = std::move(result);
  return {};
}

Result<void> mirror(Timeline& timeline, double plane_x_m) {
  Timeline result = timeline;
  for (HandTrack& hand : result.hands) {
    hand.side = opposite(hand.side);
    for (Key& key : hand.keys)
      mirror_key(key, plane_x_m);
  }
  for (auto& masks : result.masks)
    if (masks) masks = mirrored_masks(*masks, plane_x_m * timeline.units_per_metre);
  if (result.rig) mirror_roles(result);
  if (std::string wrong = complaint_about(result); !wrong.empty())
    return Error{Errc::usage, std::move(wrong)};
  timeline = std::move(result);
  return {};
}

Result<TipSet> set_tip(Timeline& timeline, Side side, std::size_t key, hand::Finger finger,
                       const Eigen::Vector3d& target_m, double within_m) {
  auto track = track_with_key(timeline, side, key);
  if (!track) return track.error();
  if (!(target_m.cwiseAbs().maxCoeff() <= farthest_m) || !target_m.allFinite())
    return Error{Errc::usage, "the place must be within 1000 m of the stage's middle"};
  Key& edited = (*track)->keys[key];
  const hand::HandSkeleton skeleton = (*track)->skeleton();
  hand::FingertipTargets targets{};
  const auto number = static_cast<std::size_t>(finger);
  targets[number] = {target_m, 1.0};
  const hand::InverseSolution solution =
      hand::inverse_kinematics(skeleton, edited.wrist_pose(), targets, edited.angles);
  Key solved = edited;
  if (finger == hand::Finger::thumb) {
    solved.angles.thumb_roll_rad = solution.angles.thumb_roll_rad;
    solved.angles.thumb_abduction_rad = solution.angles.thumb_abduction_rad;
    solved.angles.thumb_mcp_flexion_rad = solution.angles.thumb_mcp_flexion_rad;
    solved.angles.thumb_ip_flexion_rad = solution.angles.thumb_ip_flexion_rad;
  } else {
    solved.angles[finger] = solution.angles[finger];
  }
  // Palm and wrist are as before, unless they were beyond their limits.
  const Eigen::Vector3d reached_m = skeleton.pose(solved.angles, solved.wrist_pose())
                                        .fingertip_positions()
                                        .col(static_cast<Eigen::Index>(number));
  const double off_m = (reached_m - target_m).norm();
  if (!(off_m <= within_m)) {
    char off[64];
    std::snprintf(off, sizeof off, "%.1f mm", 1e3 * off_m);
    return Error{Errc::usage, name_of_key(side, key) +
                                  ": out of reach; the nearest that the fingertip comes is " + off +
                                  " off, so choose a nearer place"};
  }
  if (const std::string wrong = complaint_about(solved); !wrong.empty())
    return Error{Errc::usage, name_of_key(side, key) + ": " + wrong};
  edited = solved;
  return TipSet{off_m};
}

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
/// `by_rad` was possible.
double bend(hand::JointAngles& angles, const std::vector<hand::Angle>& joints, double by_rad) {
  const auto space_of = [&](hand::Angle joint) {
    const hand::JointLimit& limit = hand::limit_of(joint);
    const double space =
        by_rad > 0.0 ? limit.max_rad - angles[joint] : angles[joint] - limit.min_rad;
    return std::max(0.0, space);
  };
  double space = 0.0;
  for (const hand::Angle joint : joints)
    space += space_of(joint);
  const double part = space > 0.0 ? std::min(1.0, std::abs(by_rad) / space) : 0.0;
  for (const hand::Angle joint : joints)
    angles[joint] += std::copysign(part * space_of(joint), by_rad);
  return std::copysign(part * space, by_rad);
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

Error not_reached(const KeyRef& at, const std::string& name, const AtKey& now) {
  const std::string where = name_of_key(at.side, at.key) + ": ";
  if (now.is_symmetric)
    return {Errc::usage, where + name +
                             " has the value of its twin, which is greater there while "
                             "one hand plays both sides; set that one"};
  return {Errc::usage, where + "the hand grabs " + name +
                           " there, which begins with the value that it had; choose a later key"};
}

} // namespace

Result<ValueSet> set_value(Timeline& timeline, const std::string& name, std::size_t key,
                           double value) {
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
    return refused(name_of_key(at->side, at->key) + ": the hand has released " + name +
                   " there; choose another key");
  Timeline result = timeline;
  const double by = (puppet::asked_for(function, value) - before.state.asked) * function.travel;
  if (const auto done = set_signal(result, *at, function, before, by); !done) return done.error();
  if (const std::string wrong = complaint_about(result); !wrong.empty()) return refused(wrong);
  const AtKey now = function_at(result, *number, time_s);
  constexpr double near = 5e-3; // a tip comes only near to where it should
  if (!(std::abs(now.value - value) <= near)) return not_reached(*at, name, now);
  timeline = std::move(result);
  return ValueSet{*at, now.value};
}

} // namespace nendo::timeline
