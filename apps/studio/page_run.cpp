#include "studio/page_run.hpp"

#include <nendo/base/text.hpp>

#include "session/kept_state.hpp"
#include "session/run_saving.hpp"
#include "studio/opened_files.hpp"

namespace nendo::studio {

using session::Asks;
using session::RunStatus;

namespace {

/// The tab of the run itself.
Screen screen_of(const RunStatus& status) {
  return status.frame.function_count > 0 ? Screen::puppet : Screen::shaping;
}

} // namespace

Wish describe_bar(web::PageForm& form, Screen now, const std::string& file) {
  Wish wish;
  form.part("bar");
  form.lines_of(0);
  for (const Tab& tab : tabs) {
    const bool is_now = tab.screen == now;
    const auto look = is_now ? Form::Look::chosen : Form::Look::plain;
    if (form.button(tab.name, tab.help, look) && !is_now) wish = Go{tab.screen};
  }
  if (!file.empty()) form.text(file, Form::Tone::faint);
  return wish;
}

PageRun::~PageRun() {
  timeline_.leave();
  remove_sent(waiting_);
}

void PageRun::update(const RunStatus& status, Asks& asks) {
  const HostTime now = HostClock::now();
  if (now < next_) return;
  next_ = now + picture_time;
  form_.begin(server_.next_input(web::FormKind::screen));
  const bool is_modified = status.saving->is_modified(status.frame);
  follow_recording(status);
  const Screen screen = shows_timeline_ ? Screen::timeline : screen_of(status);
  const std::string shape = file_ + (is_modified ? " *" : "");
  const Wish wish = describe_bar(form_, screen, shows_timeline_ ? timeline_.title() : shape);
  if (is_wish(wish)) go(wish, status, asks);
  open_sent(status, asks);
  follow_saving(status, asks);
  show_dialog(status, asks);
  if (shows_timeline_) show_timeline(status, asks);
  if (form_.has_new_pictures()) server_.set_pictures(form_.pictures());
  server_.set_form(web::FormKind::screen, form_.message(shows_timeline_ ? "timeline" : "shaping"));
}

/// The timeline opens the new recording, unless another timeline is in use, or the user has opened
/// one since the recording began.
void PageRun::follow_recording(const RunStatus& status) {
  const bool recorded_before = std::exchange(records_, status.facts.recorded);
  if (records_ && !recorded_before) has_chosen_ = false;
  if (status.recorded == recorded_) return;
  recorded_ = status.recorded;
  session::keep_recent_file(recorded_);
  const bool opens = !has_chosen_ && !timeline_.is_in_use();
  if (opens)
    timeline_.open(Open{recorded_});
  else
    notify("Recorded in " + printable(recorded_), Form::Tone::plain);
}

void PageRun::follow_saving(const RunStatus& status, Asks& asks) {
  if (std::exchange(saves_, status.saving->saves()) == status.saving->saves()) return;
  session::keep_recent_file(status.saving->saved());
  if (saves_first_) leave(asks);
}

void PageRun::open_sent(const RunStatus& status, Asks& asks) {
  const auto file = server_.take_file();
  if (!file) return;
  dialog_.close();
  const auto stored = store_sent(file->name, file->bytes, timeline_.out());
  if (stored)
    go(Open{*stored, true}, status, asks);
  else
    notify(stored.error().message);
}

/// The line for reports is hidden while the timeline is shown.
void PageRun::notify(const std::string& message, Form::Tone tone) {
  if (!shows_timeline_) return server_.report(message, tone == Form::Tone::warning);
  message_ = message;
  tone_ = tone;
}

void PageRun::show_dialog(const RunStatus& status, Asks& asks) {
  if (!message_.empty()) {
    if (show_message(form_, message_, tone_)) message_.clear();
  } else if (timeline_.is_asking()) {
    const auto wish = timeline_.ask(form_);
    if (!wish) return notify(wish.error().message);
    if (is_wish(*wish)) go(*wish, status, asks);
  } else if (is_wish(waiting_)) {
    ask(asks);
  } else if (dialog_.is_open()) {
    const Wish wish = dialog_.describe(form_);
    if (is_wish(wish)) go(wish, status, asks);
  }
}

void PageRun::show_timeline(const RunStatus& status, Asks& asks) {
  const auto wish = timeline_.update(form_);
  if (wish && is_wish(*wish)) go(*wish, status, asks);
  if (wish) return;
  server_.report(wish.error().message, true);
  go_to(screen_of(status), status, asks);
}

/// The run continues beside the timeline, and its hands release the model meanwhile.
void PageRun::go_to(Screen screen, const RunStatus& status, Asks& asks) {
  const bool is_timeline = screen == Screen::timeline;
  if (std::exchange(shows_timeline_, is_timeline) == is_timeline) return;
  if (!is_timeline) {
    timeline_.leave();
    if (std::exchange(held_, false)) asks.emplace_back(flow::Request::grab);
    return;
  }
  // The recording that ends is the one to be shown.
  if (status.facts.recorded) asks.emplace_back(flow::SetRecording{false});
  held_ = status.frame.held;
  if (held_) asks.emplace_back(flow::Request::release);
  if (!timeline_.is_open()) timeline_.open(Open{recorded_});
}

/// A save that fails keeps the user here.
void PageRun::report(const session::Report& message) {
  if (!message.is_error || !std::exchange(saves_first_, false)) return;
  if (shows_timeline_) notify(message.text);
}

void PageRun::go(const Wish& wish, const RunStatus& status, Asks& asks) {
  if (const auto* const there = std::get_if<Go>(&wish))
    if (there->screen == Screen::timeline ||
        (there->screen == screen_of(status) && shows_timeline_))
      return go_to(there->screen, status, asks);
  const auto* const file = std::get_if<Open>(&wish);
  if (file != nullptr && file->file.empty()) return dialog_.open();
  if (file != nullptr)
    if (const auto fine = check_there(file->file); !fine) return notify(fine.error().message);
  if (!timeline_.lets(wish)) return;
  if (file != nullptr && opens_in_timeline(file->file)) {
    timeline_.open(*file);
    has_chosen_ = true;
    session::keep_recent_file(file->file);
    return go_to(Screen::timeline, status, asks);
  }
  remove_sent(std::exchange(waiting_, wish));
  if (!asks_to_save_ || !status.saving->is_modified(status.frame)) leave(asks);
}

void PageRun::ask(Asks& asks) {
  const auto answer = ask_to_save(form_, "the shape of " + file_);
  if (!answer) return;
  saves_first_ = *answer == Answer::save;
  if (*answer == Answer::save) asks.emplace_back(flow::SaveShape{});
  if (*answer == Answer::discard) leave(asks);
  if (*answer == Answer::stay) remove_sent(std::exchange(waiting_, {}));
}

void PageRun::leave(Asks& asks) {
  left_for_ = std::exchange(waiting_, {});
  is_settled_ = asks_to_save_;
  saves_first_ = false;
  asks.emplace_back(flow::EndRun{});
}

} // namespace nendo::studio
