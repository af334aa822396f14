#include "timeline/edit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "timeline/edit_parts.hpp"
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
  return std::lower_bound(keys.begin(), keys.end(), time_s,
                          [](const Key& key, double time) { return key.time_s < time; });
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

// Of all keys, in order and without the same twice. What moves towards a key behind the end does so
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

} // namespace

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
  const auto anew = [&](double time_s) {
    if (time_s <= from_s) return time_s;
    if (time_s <= to_s) return from_s + scale * (time_s - from_s);
    return from_s + scale * (to_s - from_s) + (time_s - to_s);
  };
  Timeline result = timeline;
  result.duration_s = anew(timeline.duration_s);
  for (auto& hand : result.hands)
    for (Key& key : hand.keys)
      key.time_s = anew(key.time_s);
  for (Event& event : result.events)
    event.time_s = anew(event.time_s);
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

} // namespace nendo::timeline
