#include "timeline/timeline_change.hpp"

#include <algorithm>
#include <cassert>

namespace nendo::timeline {
namespace {

// What both have at their beginnings and ends stays out of it.
template <class T>
Splice<T> splice_between(const std::vector<T>& before, const std::vector<T>& after) {
  const auto alike = [](const T& one, const T& other) { return same_bits(one, other); };
  const auto [left, left_after] =
      std::mismatch(before.begin(), before.end(), after.begin(), after.end(), alike);
  const auto [right, right_after] =
      std::mismatch(before.rbegin(), std::make_reverse_iterator(left), after.rbegin(),
                    std::make_reverse_iterator(left_after), alike);
  return {static_cast<std::size_t>(left - before.begin()),
          {left, right.base()},
          {left_after, right_after.base()}};
}

template <class T>
void put(std::vector<T>& list, const Splice<T>& splice, bool forth) {
  const auto& out = forth ? splice.before : splice.after;
  const auto& in = forth ? splice.after : splice.before;
  const auto begin = list.begin() + static_cast<std::ptrdiff_t>(splice.at);
  const auto place = list.erase(begin, begin + static_cast<std::ptrdiff_t>(out.size()));
  list.insert(place, in.begin(), in.end());
}

void go(Timeline& timeline, const TimelineChange& change, bool forth) {
  timeline.duration_s = forth ? change.duration_after_s : change.duration_before_s;
  for (std::size_t at = 0; at < change.hands.size(); ++at) {
    const auto& hand = change.hands[at];
    timeline.hands[at].side = forth ? hand.side_after : hand.side_before;
    put(timeline.hands[at].keys, hand.keys, forth);
  }
  put(timeline.events, change.events, forth);
  put(timeline.rig_state.functions, change.functions, forth);
}

} // namespace

TimelineChange change_between(const Timeline& before, const Timeline& after) {
  assert(before.hands.size() == after.hands.size());
  TimelineChange change;
  change.duration_before_s = before.duration_s;
  change.duration_after_s = after.duration_s;
  for (std::size_t at = 0; at < before.hands.size(); ++at)
    change.hands.push_back({before.hands[at].side, after.hands[at].side,
                            splice_between(before.hands[at].keys, after.hands[at].keys)});
  change.events = splice_between(before.events, after.events);
  change.functions = splice_between(before.rig_state.functions, after.rig_state.functions);
  return change;
}

bool is_empty(const TimelineChange& change) noexcept {
  return same_bits(change.duration_before_s, change.duration_after_s) && change.events.is_empty() &&
         change.functions.is_empty() &&
         std::all_of(change.hands.begin(), change.hands.end(), [](const auto& hand) {
           return hand.side_before == hand.side_after && hand.keys.is_empty();
         });
}

void do_change(Timeline& timeline, const TimelineChange& change) {
  go(timeline, change, true);
}

void undo_change(Timeline& timeline, const TimelineChange& change) {
  go(timeline, change, false);
}

} // namespace nendo::timeline
