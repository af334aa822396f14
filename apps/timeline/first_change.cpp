#include "timeline/first_change.hpp"

#include <algorithm>
#include <cmath>

#include "timeline/hand_curve.hpp"

namespace nendo::timeline {
namespace {

// The frame before the one in which the first of the events that differ is due.
std::uint64_t frames_before_events(const Timeline& before, const Timeline& after,
                                   std::uint64_t most) {
  const auto [one, other] = std::mismatch(
      before.events.begin(), before.events.end(), after.events.begin(), after.events.end(),
      [](const Event& a, const Event& b) { return same_bits(a, b); });
  double first_s = longest_s;
  if (one != before.events.end()) first_s = std::min(first_s, one->time_s);
  if (other != after.events.end()) first_s = std::min(first_s, other->time_s);
  if (one == before.events.end() && other == after.events.end()) return most;
  const double frame = std::floor(first_s * before.rate_hz) - 1.0;
  return std::min(most, frame > 0.0 ? static_cast<std::uint64_t>(frame) : 0);
}

} // namespace

std::uint64_t unchanged_frames(const Timeline& before, std::uint64_t frames_before,
                               const Timeline& after, std::uint64_t frames_after,
                               std::uint64_t most) {
  if (before.hands.size() != after.hands.size()) return 0;
  if (before.rig != after.rig || before.rig_state != after.rig_state) return 0;
  if (before.masks != after.masks) return 0;
  most = std::min({most, frames_before, frames_after});
  // In the last frame, all that was asked for and is left is done.
  if (frames_before != frames_after)
    most = std::min(most, std::min(frames_before, frames_after) - 1);
  most = frames_before_events(before, after, most);
  for (std::size_t at = 0; at < before.hands.size(); ++at) {
    if (before.hands[at].side != after.hands[at].side) return 0;
    const HandCurve one(before.hands[at].keys);
    const HandCurve other(after.hands[at].keys);
    for (std::uint64_t frame = 0; frame < most; ++frame) {
      const double time_s = static_cast<double>(frame) / after.rate_hz;
      if (!same_bits(one.at(time_s), other.at(time_s))) most = frame;
    }
  }
  return most;
}

} // namespace nendo::timeline
