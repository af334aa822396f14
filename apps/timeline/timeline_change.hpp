#pragma once
// The difference that an edit made. It is a step of EditHistory.

#include <cstddef>
#include <vector>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

/// A change of a list: at index `at`, `before` was replaced by `after`.
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
  std::vector<Hand> hands; ///< in the order of the timeline's hands
  Splice<Event> events;
  Splice<puppet::FunctionState> functions; ///< of the puppet, at 0 s
};

/// Compares all that edits change: durations, sides, keys, events, and what a puppet listens to.
/// Both must have the same number of hands.
TimelineChange change_between(const Timeline& before, const Timeline& after);
bool is_empty(const TimelineChange& change) noexcept;
/// These apply the change or take it back, bit for bit.
void do_change(Timeline& timeline, const TimelineChange& change);
void undo_change(Timeline& timeline, const TimelineChange& change);

} // namespace nendo::timeline
