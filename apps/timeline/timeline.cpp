#include "timeline/timeline.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>

#include <nendo/flow/tick_grid.hpp>

namespace nendo::timeline {
namespace {

constexpr double most_angle_rad = 2.0 * std::numbers::pi;
constexpr double least_positive = 1e-100;
constexpr double largest = 1e100; // as the solver takes

bool within(double value, double least, double most) noexcept {
  return value >= least && value <= most; // false for NaN
}

bool is_place(const Eigen::Vector3d& place_m) noexcept {
  return within(place_m.x(), -farthest_m, farthest_m) &&
         within(place_m.y(), -farthest_m, farthest_m) &&
         within(place_m.z(), -farthest_m, farthest_m);
}

std::string complaint_about(const HandTrack& track) {
  const std::string whose = std::string(name_of(track.side)) + " hand";
  constexpr double least_hand_m = 0.01;
  if (!within(track.size.length_m, least_hand_m, 1.0) ||
      !within(track.size.breadth_m, least_hand_m, 1.0))
    return whose + ": length and breadth must lie within 0.01 and 1 m";
  if (track.keys.empty()) return whose + ": has no key; a hand needs one at least";
  if (track.keys.size() > most_keys)
    return whose + ": has more than " + std::to_string(most_keys) + " keys";
  for (std::size_t at = 0; at < track.keys.size(); ++at) {
    std::string wrong = complaint_about(track.keys[at]);
    if (wrong.empty() && at > 0 && !(track.keys[at].time_s > track.keys[at - 1].time_s))
      wrong = "its time must be after that of the key before";
    if (!wrong.empty()) return whose + ", key " + std::to_string(at) + ": " + wrong;
  }
  return {};
}

std::string complaint_about(const flow::SculptorOptions& sculptor, std::size_t hands) {
  const auto& options = sculptor.deformer;
  if (!within(sculptor.piece_length, least_positive, largest))
    return "piece_length must be positive";
  if (!within(sculptor.brush_strength, -1.0, 1.0)) return "brush_strength must lie within -1 and 1";
  if (options.supports.shared.empty() || !options.supports.are_usable())
    return "supports: radii and weights must be positive, and one at least must be shared";
  for (const auto& own : options.supports.own)
    if (own.point < 0 || own.point >= 5 * static_cast<Eigen::Index>(hands))
      return "supports: there is no fingertip " + std::to_string(own.point);
  if (!within(options.csrbf.merge_fraction, 0.0, 1.0))
    return "merge_fraction must lie within 0 and 1";
  constexpr std::size_t most_weight_bytes = std::size_t{1} << 28;
  if (options.evaluation.weight_bytes > most_weight_bytes)
    return "weight_bytes must be at most " + std::to_string(most_weight_bytes);
  if (!options.injective) return {};
  constexpr int most_links = 1024;
  if (!within(options.injective->most_bound, 0.01, 0.999) || options.injective->most_links < 1 ||
      options.injective->most_links > most_links || !within(options.injective->least_gap, 0.0, 1.0))
    return "injective: most_bound must lie within 0.01 and 0.999, most_links within 1 and 1024, "
           "least_gap within 0 and 1";
  return {};
}

std::string complaint_about(const std::vector<Event>& events) {
  if (events.size() > most_events)
    return "has more than " + std::to_string(most_events) + " events";
  for (std::size_t at = 0; at < events.size(); ++at) {
    if (!within(events[at].time_s, 0.0, longest_s) ||
        (at > 0 && events[at].time_s < events[at - 1].time_s))
      return "event " + std::to_string(at) + ": times must lie within 0 and 1000000 s and not fall";
    if (events[at].settings && !events[at].settings->are_usable())
      return "event " + std::to_string(at) +
             ": radii must lie within 1e-9 and 1e9 m, piece_fraction within 0.001 and 1000";
  }
  return {};
}

} // namespace

Eigen::Isometry3d Key::wrist_pose() const noexcept {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = wrist_turn.normalized().toRotationMatrix();
  pose.translation() = wrist_m;
  return pose;
}

bool same_bits(double one, double other) noexcept {
  return std::bit_cast<std::uint64_t>(one) == std::bit_cast<std::uint64_t>(other);
}

bool same_bits(const Key& one, const Key& other) noexcept {
  bool equal = same_bits(one.time_s, other.time_s);
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    equal = equal && same_bits(one.angles[hand::angle_at(at)], other.angles[hand::angle_at(at)]);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    equal = equal && same_bits(one.wrist_m[axis], other.wrist_m[axis]);
  for (Eigen::Index part = 0; part < 4; ++part)
    equal = equal && same_bits(one.wrist_turn.coeffs()[part], other.wrist_turn.coeffs()[part]);
  return equal;
}

bool same_bits(const Event& one, const Event& other) noexcept {
  return same_bits(one.time_s, other.time_s) && one.request == other.request &&
         one.settings == other.settings && one.subdivides == other.subdivides;
}

std::string in_words(const Event& event) {
  if (event.subdivides) return "subdivide";
  if (!event.settings) return std::string(name_of(event.request));
  const flow::LoopSettings& settings = *event.settings;
  std::string words = std::string(name_of(settings.mode)) + ", " +
                      std::string(deform::name_of(settings.kernel)) +
                      (settings.injective ? ", never folds, radius" : ", radius");
  const auto [least, most] =
      std::minmax_element(settings.radius_m.begin(), settings.radius_m.end());
  char radius[64];
  std::snprintf(radius, sizeof radius, " %.3g", 100.0 * *least);
  words += radius;
  std::snprintf(radius, sizeof radius, " to %.3g", 100.0 * *most);
  return words + (*least == *most ? "" : radius) + " cm";
}

HandTrack* Timeline::track(Side side) noexcept {
  const auto found = std::find_if(hands.begin(), hands.end(),
                                  [side](const HandTrack& hand) { return hand.side == side; });
  return found == hands.end() ? nullptr : &*found;
}

const HandTrack* Timeline::track(Side side) const noexcept {
  const auto found = std::find_if(hands.begin(), hands.end(),
                                  [side](const HandTrack& hand) { return hand.side == side; });
  return found == hands.end() ? nullptr : &*found;
}

std::size_t Timeline::key_count() const noexcept {
  std::size_t count = 0;
  for (const auto& hand : hands)
    count += hand.keys.size();
  return count;
}

std::string complaint_about(const Key& key) {
  if (!within(key.time_s, 0.0, longest_s)) return "its time must lie within 0 and 1000000 s";
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    if (!within(key.angles[hand::angle_at(at)], -most_angle_rad, most_angle_rad))
      return std::string(hand::angle_names[at]) + " must lie within a full turn either way";
  if (!is_place(key.wrist_m)) return "the wrist must be within 1000 m";
  if (!within(key.wrist_turn.norm(), 0.99, 1.01))
    return "wrist_turn must be a quaternion of unit length";
  return {};
}

std::string complaint_about(const Timeline& timeline) {
  if (!within(timeline.units_per_metre, least_positive, largest))
    return "units_per_metre must be positive";
  if (!within(timeline.rate_hz, flow::TickGrid::least_rate_hz, flow::TickGrid::most_rate_hz))
    return "rate_hz must lie within 1 and 10000";
  if (!within(timeline.duration_s, 0.0, longest_s))
    return "duration_s must lie within 0 and 1000000";
  if (timeline.hands.empty() || timeline.hands.size() > 2 ||
      (timeline.hands.size() == 2 && timeline.hands[0].side == timeline.hands[1].side))
    return "must have one or two hands, of different sides";
  for (const auto& hand : timeline.hands)
    if (auto wrong = complaint_about(hand); !wrong.empty()) return wrong;
  if (auto wrong = complaint_about(timeline.sculptor, timeline.hands.size()); !wrong.empty())
    return wrong;
  return complaint_about(timeline.events);
}

} // namespace nendo::timeline
