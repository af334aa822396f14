#pragma once
// What an edit did, as little as it was: a step of EditHistory.

#include <cstddef>
#include <vector>

#include <nendo/timeline/timeline.hpp>

namespace nendo::timeline {

/// In a list, `before` stood at `at`, and `after` stands there now.
template <class T>
struct Splice {
  std::size_t at = 0;
  std::vector<T> before, after;
  bool is_empty() const noexcept { return before.empty() && after.empty(); }
};

struct TimelineChange {
  struct Hand {
    Side side_before, side_after;
    Splice<Key> keys;
  };
  double duration_before_s = 0.0;
  double duration_after_s = 0.0;
  std::vector<Hand> hands; ///< by the timeline's
  Splice<Event> events;
};

/// Of all that edits change: durations, sides, keys and events. Both have as many hands.
TimelineChange change_between(const Timeline& before, const Timeline& after);
bool is_empty(const TimelineChange& change) noexcept;
/// From the one before to the one after, and back, bit for bit.
void do_change(Timeline& timeline, const TimelineChange& change);
void undo_change(Timeline& timeline, const TimelineChange& change);

} // namespace nendo::timeline
