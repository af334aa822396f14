#include "studio/timeline_tab.hpp"

#include "studio/opened_files.hpp"
#include "studio/waiting.hpp"

namespace nendo::studio {

void TimelineTab::open(const std::string& file) {
  editing_.reset();
  timeline_.open(Open{file});
}

void TimelineTab::open(const FirstTimeline& first) {
  editing_.reset();
  timeline_.open(first);
}

void TimelineTab::enter(const std::string& usual) {
  if (!is_open()) open(usual);
  if (editing_) editing_->show_again();
}

/// Says what is done, or what there is to do.
Wish TimelineTab::show_waiting_words() {
  const std::string button = is_open() ? "" : open_button;
  const bool is_asked = show_waiting(*window_, timeline_.waiting_words(), button);
  if (window_->take_close_request()) return Quit{};
  return is_asked ? Wish{Open{}} : Wish{};
}

Result<Wish> TimelineTab::show() {
  bar_.set({Screen::timeline, timeline_.file(), is_modified(), false});
  const auto session = timeline_.read();
  if (!session) return session.error();
  if (*session == nullptr) return show_waiting_words();
  if (!editing_)
    editing_ = std::make_unique<edit::WindowEditing>(window_, **session, timeline_.model());
  const auto shown = editing_->show();
  if (shown) return editing_->quits() ? Wish{Quit{}} : Wish{};
  editing_.reset();
  timeline_.close();
  return shown.error();
}

bool TimelineTab::lets(const Wish& wish) {
  const auto* const file = std::get_if<Open>(&wish);
  if (file != nullptr && file->file.empty()) {
    bar_.ask_what_to_open();
    return false;
  }
  if (timeline_.lets(wish)) return true;
  bar_.ask(timeline_.unsaved());
  return false;
}

Wish TimelineTab::take_settled() {
  if (!timeline_.is_asking()) return {};
  const auto answer = bar_.take_answer();
  if (!answer) return {};
  const auto wish = timeline_.settle(*answer);
  if (wish) return *wish;
  bar_.show_error(wish.error().message);
  return {};
}

} // namespace nendo::studio
