#include <nendo/flow/layer.hpp>

#include <algorithm>

#include <nendo/hand/angle.hpp>
#include <nendo/hand/joints.hpp>

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
  for (bool is_last = false; !is_last;) {
    const auto comma = text.find(',');
    is_last = comma == std::string_view::npos;
    const std::string_view word = text.substr(0, comma);
    if (!is_last) text.remove_prefix(comma + 1);
    const auto point = word.find('.');
    const std::string_view side = word.substr(0, point);
    if (side != "left" && side != "right") return std::nullopt;
    const auto angles = point == std::string_view::npos ? std::optional(AngleSet::all())
                                                        : angles_named(word.substr(point + 1));
    if (!angles) return std::nullopt;
    hands[side == "left" ? 0 : 1].bits |= angles->bits;
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

} // namespace nendo::flow
