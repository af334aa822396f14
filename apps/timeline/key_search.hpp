#pragma once
// Finds keys of a timeline.

#include <optional>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

struct KeyRef {
  Side side = Side::right;
  std::size_t key = 0; ///< counted from 0

  friend bool operator==(const KeyRef&, const KeyRef&) = default;
};

/// Returns null if there is no such key.
const Key* find_key(const Timeline& timeline, const KeyRef& key) noexcept;
/// Returns the hand's key at exactly that time.
std::optional<KeyRef> key_at(const Timeline& timeline, Side side, double time_s) noexcept;
/// Return the nearest key after or before time_s, either of the hand of that side or of any hand.
std::optional<KeyRef> key_after(const Timeline& timeline, double time_s,
                                std::optional<Side> side = std::nullopt) noexcept;
std::optional<KeyRef> key_before(const Timeline& timeline, double time_s,
                                 std::optional<Side> side = std::nullopt) noexcept;

} // namespace nendo::timeline
