#include "timeline/edit_history.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>
#include <vector>

namespace nendo::timeline {
namespace {

/// A change of a list: at index `at`, `before` was replaced by `after`.
template <class T>
struct Splice {
  std::size_t at = 0;
  std::vector<T> before, after;
  bool is_empty() const noexcept { return before.empty() && after.empty(); }
};

/// The difference that an edit made.
struct TimelineChange {
  struct Hand {
    Side side_before, side_after;
    Splice<Key> keys;
  };
  double duration_before_s = 0.0;
  double duration_after_s = 0.0;
  std::vector<Hand> hands; ///< in the order of the timeline's hands
  Splice<Event> events;
  Splice<puppet::FunctionState> functions; ///< the puppet's functions, at 0 s
};

// What both have at their beginnings and ends stays out of it.
template <class T>
Splice<T> splice_between(const std::vector<T>& before, const std::vector<T>& after) {
  const auto alike = [](const T& one, const T& other) { return same_bits(one, other); };
  const auto [left, left_after] = std::ranges::mismatch(before, after, alike);
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

/// Redoes the change, or undoes it, bit for bit.
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

/// Compares all that edits change: durations, sides, keys, events, and what a puppet listens to.
/// Both must have the same number of hands.
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
         change.functions.is_empty() && std::ranges::all_of(change.hands, [](const auto& hand) {
           return hand.side_before == hand.side_after && hand.keys.is_empty();
         });
}

} // namespace

struct EditHistory::Step {
  TimelineChange change;
  std::optional<KeyRef> selected_before, selected_after;
};

struct EditHistory::Base {
  Timeline timeline;
  std::optional<KeyRef> selected;
};

EditHistory::EditHistory(Timeline timeline) : timeline_(std::move(timeline)) {}
EditHistory::~EditHistory() = default;

void EditHistory::select(std::optional<KeyRef> key) noexcept {
  selected_ = key && find_key(timeline_, *key) != nullptr ? key : std::nullopt;
}

void EditHistory::go_to(const std::optional<KeyRef>& selected) noexcept {
  select(selected);
  ++revision_;
}

Result<void> EditHistory::apply(const Edit& edit) {
  keep();
  const auto done = try_out(edit);
  if (done)
    keep();
  else
    drop();
  return done;
}

Result<void> EditHistory::try_out(const Edit& edit) {
  Timeline tried = base_ ? base_->timeline : timeline_;
  const auto selected = edit(tried);
  if (!selected) return selected.error();
  if (!base_) base_.reset(new Base{std::move(timeline_), selected_});
  timeline_ = std::move(tried);
  go_to(*selected);
  return {};
}

void EditHistory::keep() {
  if (!base_) return;
  const std::unique_ptr<Base> base = std::move(base_);
  TimelineChange change = change_between(base->timeline, timeline_);
  if (is_empty(change)) return;
  if (saved_ && *saved_ > done_) saved_.reset(); // what was saved can no longer be reached
  steps_.erase(steps_.begin() + static_cast<std::ptrdiff_t>(done_), steps_.end());
  steps_.push_back({std::move(change), base->selected, selected_});
  done_ = steps_.size();
}

void EditHistory::drop() {
  if (!base_) return;
  const std::unique_ptr<Base> base = std::move(base_);
  timeline_ = std::move(base->timeline);
  go_to(base->selected);
}

bool EditHistory::undo() {
  keep();
  if (done_ == 0) return false;
  const Step& step = steps_[--done_];
  go(timeline_, step.change, false);
  go_to(step.selected_before);
  return true;
}

bool EditHistory::redo() {
  keep();
  if (done_ == steps_.size()) return false;
  const Step& step = steps_[done_++];
  go(timeline_, step.change, true);
  go_to(step.selected_after);
  return true;
}

bool EditHistory::can_redo() const noexcept {
  return done_ < steps_.size() && !is_trying();
}

bool EditHistory::is_modified() const noexcept {
  return is_trying() || saved_ != done_;
}

void EditHistory::saved() {
  keep();
  saved_ = done_;
}

} // namespace nendo::timeline
