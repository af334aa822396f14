#include "takes/key_poses.hpp"

#include <algorithm>
#include <limits>

#include <nendo/hand/angle.hpp>

namespace nendo::takes {
namespace {

constexpr std::size_t max_poses = 20'000; // of longer takes, every other frame, or fewer

struct Pose {
  double time_s;
  std::vector<double> numbers;
};

std::vector<double> numbers_of(const flow::Frame& frame) {
  if (frame.function_count > 0)
    return {frame.functions.begin(), frame.functions.begin() + frame.function_count};
  std::vector<double> numbers;
  for (const flow::HandFrame& hand : frame.hands)
    for (std::size_t angle = 0; hand.present && angle < hand::angle_count; ++angle)
      numbers.push_back(hand.angles[hand::angle_at(angle)]);
  return numbers;
}

double squared_difference(const Pose& one, const Pose& other) {
  double sum = 0.0;
  for (std::size_t at = 0; at < std::min(one.numbers.size(), other.numbers.size()); ++at) {
    const double apart = one.numbers[at] - other.numbers[at];
    sum += apart * apart;
  }
  return sum;
}

std::vector<Pose> poses_of(FrameSource& frames) {
  std::vector<Pose> poses;
  std::size_t every = 1;
  for (std::size_t number = 0; frames.next(); ++number) {
    if (number % every != 0) continue;
    poses.push_back({frames.time_s(), numbers_of(frames.frame())});
    if (poses.size() < max_poses) continue;
    for (std::size_t at = 1; 2 * at < poses.size(); ++at)
      poses[at] = std::move(poses[2 * at]);
    poses.resize((poses.size() + 1) / 2);
    every *= 2;
  }
  return poses;
}

/// Which of them the hands hold. Hands pass many poses on their way; they mean those that they
/// hold.
std::vector<bool> held(const std::vector<Pose>& poses) {
  constexpr double about_s = 0.1;
  constexpr double max_part = 0.05; // of the fastest change, squared
  std::vector<double> change(poses.size());
  std::size_t from = 0;
  std::size_t to = 0;
  for (std::size_t at = 0; at < poses.size(); ++at) {
    while (poses[at].time_s - poses[from].time_s > about_s)
      ++from;
    while (to + 1 < poses.size() && poses[to + 1].time_s - poses[at].time_s <= about_s)
      ++to;
    change[at] = squared_difference(poses[from], poses[to]);
  }
  const double most = poses.empty() ? 0.0 : *std::max_element(change.begin(), change.end());
  std::vector<bool> held;
  for (const double one : change)
    held.push_back(one <= max_part * most);
  return held;
}

/// The one that is farthest from all that were chosen: of those that are held, or else of all.
std::size_t farthest(const std::vector<double>& nearest, const std::vector<bool>& held) {
  std::size_t best = 0;
  for (const bool any : {false, true}) {
    for (std::size_t at = 0; at < nearest.size(); ++at)
      if ((any || held[at]) && nearest[at] > nearest[best]) best = at;
    if (nearest[best] > 0.0) break;
  }
  return best;
}

} // namespace

std::vector<double> key_poses(FrameSource& frames, std::size_t count) {
  const std::vector<Pose> poses = poses_of(frames);
  const std::vector<bool> is_held = held(poses);
  std::vector<double> times;
  std::vector<double> nearest(poses.size(), std::numeric_limits<double>::infinity());
  for (std::size_t next = 0; times.size() < std::min(count, poses.size());) {
    times.push_back(poses[next].time_s);
    for (std::size_t at = 0; at < poses.size(); ++at)
      nearest[at] = std::min(nearest[at], squared_difference(poses[at], poses[next]));
    next = farthest(nearest, is_held);
    if (!(nearest[next] > 0.0)) break;
  }
  std::sort(times.begin(), times.end());
  return times;
}

} // namespace nendo::takes
