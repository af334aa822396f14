#include "timeline/hand_curve.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace nendo::timeline {

HandCurve::HandCurve(std::vector<Key> keys) : keys_(std::move(keys)), slopes_(keys_.size()) {
  assert(!keys_.empty());
  for (std::size_t key = 0; key < keys_.size(); ++key)
    for (std::size_t at = 0; at < channel_count; ++at)
      slopes_[key][at] = slope(key, at);
}

double& HandCurve::channel(Key& key, std::size_t at) noexcept {
  return at < hand::angle_count ? key.angles[hand::angle_at(at)]
                                : key.wrist_m[static_cast<Eigen::Index>(at - hand::angle_count)];
}

double HandCurve::channel(const Key& key, std::size_t at) noexcept {
  return at < hand::angle_count ? key.angles[hand::angle_at(at)]
                                : key.wrist_m[static_cast<Eigen::Index>(at - hand::angle_count)];
}

double HandCurve::secant(std::size_t interval, std::size_t at) const noexcept {
  const Key& begin = keys_[interval];
  const Key& end = keys_[interval + 1];
  return (channel(end, at) - channel(begin, at)) / (end.time_s - begin.time_s);
}

double HandCurve::slope(std::size_t key, std::size_t at) const noexcept {
  if (keys_.size() == 1) return 0.0;
  if (key == 0) return secant(0, at);
  if (key + 1 == keys_.size()) return secant(key - 1, at);
  const double before = secant(key - 1, at);
  const double after = secant(key, at);
  if (!(before * after > 0.0)) return 0.0; // a turn, or a rest
  const double length = keys_[key].time_s - keys_[key - 1].time_s;
  const double next_length = keys_[key + 1].time_s - keys_[key].time_s;
  const double weight_before = length + 2.0 * next_length;
  const double weight_after = 2.0 * length + next_length;
  return (weight_before + weight_after) / (weight_before / before + weight_after / after);
}

Key HandCurve::at(double time_s) const noexcept {
  const auto after =
      std::upper_bound(keys_.begin(), keys_.end(), time_s,
                       [](double time, const Key& key) { return time < key.time_s; });
  const auto held = [time_s](Key key) {
    key.time_s = time_s;
    return key;
  };
  if (after == keys_.begin()) return held(keys_.front());
  if (after == keys_.end() || (after - 1)->time_s == time_s) return held(*(after - 1));
  const Key& begin = *(after - 1);
  const Key& end = *after;
  const auto index = static_cast<std::size_t>(after - keys_.begin()) - 1;
  const double length = end.time_s - begin.time_s;
  const double t = (time_s - begin.time_s) / length;
  const double to_end = t * t * (3.0 - 2.0 * t);
  const double bulge_begin = t * (1.0 - t) * (1.0 - t) * length;
  const double bulge_end = t * t * (t - 1.0) * length;
  Key key;
  key.time_s = time_s;
  for (std::size_t at = 0; at < channel_count; ++at) {
    const double from = channel(begin, at);
    const double to = channel(end, at);
    const double value = from + (to - from) * to_end + bulge_begin * slopes_[index][at] +
                         bulge_end * slopes_[index + 1][at];
    channel(key, at) = std::clamp(value, std::min(from, to), std::max(from, to)); // of rounding
  }
  key.wrist_turn = begin.wrist_turn.normalized().slerp(t, end.wrist_turn.normalized());
  return key;
}

} // namespace nendo::timeline
