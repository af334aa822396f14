#include "timeline/key_search.hpp"

#include <algorithm>

namespace nendo::timeline {
namespace {

auto first_from(const std::vector<Key>& keys, double time_s) noexcept {
  return std::lower_bound(keys.begin(), keys.end(), time_s,
                          [](const Key& key, double time) { return key.time_s < time; });
}

std::size_t index_in(const std::vector<Key>& keys, std::vector<Key>::const_iterator key) noexcept {
  return static_cast<std::size_t>(key - keys.begin());
}

} // namespace

const Key* find_key(const Timeline& timeline, const KeyRef& key) noexcept {
  const HandTrack* const track = timeline.track(key.side);
  return track == nullptr || key.key >= track->keys.size() ? nullptr : &track->keys[key.key];
}

std::optional<KeyRef> key_at(const Timeline& timeline, Side side, double time_s) noexcept {
  const HandTrack* const track = timeline.track(side);
  if (track == nullptr) return std::nullopt;
  const auto found = first_from(track->keys, time_s);
  if (found == track->keys.end() || found->time_s != time_s) return std::nullopt;
  return KeyRef{side, index_in(track->keys, found)};
}

std::optional<KeyRef> key_after(const Timeline& timeline, double time_s,
                                std::optional<Side> side) noexcept {
  std::optional<KeyRef> nearest;
  for (const HandTrack& hand : timeline.hands) {
    if (side && hand.side != *side) continue;
    auto found = first_from(hand.keys, time_s);
    if (found != hand.keys.end() && found->time_s == time_s) ++found;
    if (found == hand.keys.end()) continue;
    if (!nearest || found->time_s < find_key(timeline, *nearest)->time_s)
      nearest = KeyRef{hand.side, index_in(hand.keys, found)};
  }
  return nearest;
}

std::optional<KeyRef> key_before(const Timeline& timeline, double time_s,
                                 std::optional<Side> side) noexcept {
  std::optional<KeyRef> nearest;
  for (const HandTrack& hand : timeline.hands) {
    if (side && hand.side != *side) continue;
    const auto after = first_from(hand.keys, time_s);
    if (after == hand.keys.begin()) continue;
    if (!nearest || (after - 1)->time_s > find_key(timeline, *nearest)->time_s)
      nearest = KeyRef{hand.side, index_in(hand.keys, after - 1)};
  }
  return nearest;
}

} // namespace nendo::timeline
