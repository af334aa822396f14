#include "studio/page_run.hpp"

#include <filesystem>
#include <utility>

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

void remove_sent(const Wish& wish) {
  const auto* const file = std::get_if<Open>(&wish);
  std::error_code ignored;
  if (file != nullptr && file->was_sent) std::filesystem::remove(file->file, ignored);
}

PageRun::~PageRun() {
  remove_sent(waiting_);
}

void PageRun::update(const RunStatus& status, Asks& asks) {
  form_.begin(server_.next_input(web::FormKind::screen));
  const bool is_modified = status.saving->is_modified(status.frame);
  follow_recording(status);
  const Screen now = replay_ ? Screen::timeline : screen_of(status);
  const Wish wish = describe_bar(form_, now, file_ + (is_modified ? " *" : ""));
  if (is_wish(wish)) go(wish, status, asks);
  if (const auto file = server_.take_file()) {
    const auto stored = store_sent(file->name, file->bytes);
    if (stored)
      go(Open{*stored, true}, status, asks);
    else
      server_.report(stored.error().message, true);
  }
  const bool is_saved = std::exchange(saves_, status.saving->saves()) != status.saving->saves();
  if (is_saved) session::keep_recent_file(status.saving->saved());
  if (saves_first_ && is_saved) leave(asks);
  if (replay_) show_replay(status, asks);
  if (is_wish(waiting_)) ask(asks);
  server_.set_form(web::FormKind::screen, form_.message(replay_ ? "timeline" : "shaping"));
}

void PageRun::follow_recording(const RunStatus& status) {
  if (status.recorded == recorded_) return;
  recorded_ = status.recorded;
  session::keep_recent_file(recorded_);
  if (replay_) replay_ = std::make_unique<PageReplay>(server_, left_readings_, recorded_);
}

void PageRun::show_replay(const RunStatus& status, Asks& asks) {
  const auto wish = replay_->update(form_);
  if (wish && !is_wish(*wish)) return;
  if (wish) return go(*wish, status, asks);
  server_.report(wish.error().message, true);
  go_to(screen_of(status), status, asks);
}

/// The run continues beside a replay, and its hands release the model meanwhile.
void PageRun::go_to(Screen screen, const RunStatus& status, Asks& asks) {
  const bool is_timeline = screen == Screen::timeline;
  if (is_timeline == (replay_ != nullptr)) return;
  if (!is_timeline) {
    replay_.reset();
    if (std::exchange(held_, false)) asks.emplace_back(flow::Request::grab);
    return;
  }
  // The recording that ends is the one to be shown.
  if (status.facts.recorded) asks.emplace_back(flow::SetRecording{false});
  held_ = status.frame.held;
  if (held_) asks.emplace_back(flow::Request::release);
  replay_ =
      std::make_unique<PageReplay>(server_, left_readings_, status.facts.recorded ? "" : recorded_);
}

/// A save that fails keeps the user here.
void PageRun::report(const session::Report& message) {
  if (message.is_error) saves_first_ = false;
}

void PageRun::go(const Wish& wish, const RunStatus& status, Asks& asks) {
  if (const auto* const there = std::get_if<Go>(&wish))
    if (there->screen == Screen::timeline || (there->screen == screen_of(status) && replay_))
      return go_to(there->screen, status, asks);
  remove_sent(std::exchange(waiting_, wish));
  if (!asks_to_save_ || !status.saving->is_modified(status.frame)) leave(asks);
}

void PageRun::ask(Asks& asks) {
  form_.part("dialog");
  form_.text("Save the shape of " + file_ + "?");
  form_.lines_of(3);
  if (form_.button("Save", "", Form::Look::chosen)) {
    saves_first_ = true;
    asks.emplace_back(flow::SaveShape{});
  }
  if (form_.button("Discard", "")) leave(asks);
  if (!form_.button("Stay", "")) return;
  remove_sent(std::exchange(waiting_, {}));
  saves_first_ = false;
}

void PageRun::leave(Asks& asks) {
  left_for_ = std::exchange(waiting_, {});
  is_settled_ = asks_to_save_;
  saves_first_ = false;
  asks.emplace_back(flow::EndRun{});
}

} // namespace nendo::studio
