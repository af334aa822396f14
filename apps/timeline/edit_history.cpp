#include "timeline/edit_history.hpp"

#include <utility>

#include "timeline/timeline_change.hpp"

namespace nendo::timeline {

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
EditHistory::EditHistory(EditHistory&&) noexcept = default;
EditHistory& EditHistory::operator=(EditHistory&&) noexcept = default;

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
  undo_change(timeline_, step.change);
  go_to(step.selected_before);
  return true;
}

bool EditHistory::redo() {
  keep();
  if (done_ == steps_.size()) return false;
  const Step& step = steps_[done_++];
  do_change(timeline_, step.change);
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
