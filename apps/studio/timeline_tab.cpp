#include "studio/timeline_tab.hpp"

#include <nendo/base/text.hpp>

namespace nendo::studio {

bool opens_in_timeline(const std::string& file) {
  return file.ends_with(".nendo") || timeline::is_timeline(file);
}

void TimelineTab::open(const std::string& file) {
  screen_ = std::make_unique<TimelineScreen>(window_, file);
  discarded_.reset();
}

void TimelineTab::open(const FirstTimeline& first) {
  screen_ = std::make_unique<TimelineScreen>(window_, first);
  discarded_.reset();
}

void TimelineTab::enter(const std::string& usual) {
  if (!screen_) open(usual);
  screen_->show_again();
}

Wish TimelineTab::show() {
  bar_.set({Screen::timeline, screen_->file(), is_modified(), false});
  const auto wish = screen_->show();
  if (wish) return *wish;
  bar_.show_error(wish.error().message);
  screen_.reset();
  return {};
}

bool TimelineTab::has_edits_to_lose() const noexcept {
  return is_modified() && discarded_ != screen_->revision();
}

bool TimelineTab::lets(const Wish& wish) {
  const auto* const file = std::get_if<Open>(&wish);
  if (file != nullptr && file->file.empty()) {
    bar_.ask_what_to_open();
    return false;
  }
  const bool loses =
      std::holds_alternative<Quit>(wish) || (file != nullptr && opens_in_timeline(file->file));
  if (!loses || !has_edits_to_lose()) return true;
  waiting_ = wish;
  bar_.ask("the changes to " + printable(screen_->out()));
  return false;
}

Wish TimelineTab::take_settled() {
  if (!is_wish(waiting_)) return {};
  const auto answer = bar_.take_answer();
  if (!answer) return {};
  const Wish wish = std::exchange(waiting_, {});
  if (*answer == Answer::save) screen_->save();
  if (*answer == Answer::discard) discarded_ = screen_->revision();
  return has_edits_to_lose() ? Wish{} : wish;
}

} // namespace nendo::studio
