#pragma once
// Keys by their times.

#include <optional>

#include <nendo/timeline/timeline.hpp>

namespace nendo::timeline {

struct KeyRef {
  Side side = Side::right;
  std::size_t key = 0; ///< counted from 0

  friend bool operator==(const KeyRef&, const KeyRef&) = default;
};

/// Null: there is no such key.
const Key* find_key(const Timeline& timeline, const KeyRef& key) noexcept;
/// The hand's key at exactly that time.
std::optional<KeyRef> key_at(const Timeline& timeline, Side side, double time_s) noexcept;
/// The nearest one later, or earlier, than time_s: of the side's hand, or of any.
std::optional<KeyRef> key_after(const Timeline& timeline, double time_s,
                                std::optional<Side> side = std::nullopt) noexcept;
std::optional<KeyRef> key_before(const Timeline& timeline, double time_s,
                                 std::optional<Side> side = std::nullopt) noexcept;

} // namespace nendo::timeline
