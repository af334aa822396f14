#include "studio/studio_view.hpp"

#include <algorithm>
#include <utility>

#include "session/kept_state.hpp"
#include "session/run_saving.hpp"
#include "studio/opened_files.hpp"
#include "viewer/live_window.hpp"
#include "viewer/puppet_editor.hpp"

namespace nendo::studio {

using session::Asks;
using session::RunStatus;

namespace {

bool ends_run(const session::Ask& ask) {
  const auto* const command = std::get_if<flow::Command>(&ask);
  return command != nullptr && std::holds_alternative<flow::EndRun>(*command);
}

} // namespace

StudioView::StudioView(Parts parts, std::string file, bool asks_to_save)
    : parts_(std::move(parts)), file_(std::move(file)), asks_to_save_(asks_to_save) {}

StudioView::~StudioView() = default;

void StudioView::loop_begins(const session::LoopStart& start) {
  parts_.shaping->loop_begins(start);
}

Screen StudioView::screen() const noexcept {
  return parts_.shaping->window().editor().edits_puppet() ? Screen::puppet : Screen::shaping;
}

void StudioView::update(const RunStatus& status, Asks& asks) {
  follow_recording(status);
  shows_timeline_ ? show_timeline(status, asks) : show_shaping(status, asks);
  if (const auto file = parts_.bar.take_save()) {
    if (saving_ == Saving::asked) saving_ = Saving::begun;
    if (file->empty())
      asks.emplace_back(flow::SaveShape{});
    else
      asks.emplace_back(session::SaveShapeAs{*file});
  }
  for (const Wish& wish : {parts_.bar.take_wish(), timeline().take_settled()})
    if (is_wish(wish)) go(wish, status, asks);
  follow_saving(status, asks);
}

/// Closing the window, and the key q, leave the program, and not only the run.
void StudioView::show_shaping(const RunStatus& status, Asks& asks) {
  parts_.bar.set({screen(), file_, status.saving->is_modified(status.frame), true});
  Asks given;
  parts_.shaping->update(status, given);
  const bool is_ended = std::erase_if(given, ends_run) > 0;
  std::ranges::move(given, std::back_inserter(asks));
  if (is_ended) go(Quit{}, status, asks);
}

void StudioView::show_timeline(const RunStatus& status, Asks& asks) {
  const auto wish = timeline().show();
  if (wish && is_wish(*wish)) go(*wish, status, asks);
  if (wish) return;
  parts_.bar.show_error(wish.error().message);
  go_to(Screen::shaping, status, asks);
}

/// The tab opens the new recording, unless another timeline is in use, or the user has opened one
/// since the recording began.
void StudioView::follow_recording(const RunStatus& status) {
  const bool recorded_before = std::exchange(records_, status.facts.recorded);
  if (records_ && !recorded_before) has_chosen_ = false;
  if (status.recorded == recorded_) return;
  recorded_ = status.recorded;
  session::keep_recent_file(recorded_);
  const bool opens = !has_chosen_ && !timeline().is_in_use();
  if (opens) timeline().open(recorded_);
  report("recorded in " + recorded_ + (opens ? "; the tab Timeline opens it" : ""));
}

/// A run reports each save, and each that failed, which keeps the user here.
void StudioView::report(const session::Report& message) {
  if (saving_ == Saving::begun) saving_ = Saving::tried;
  parts_.shaping->report(message);
}

/// Continues when the user's answer has been carried out.
void StudioView::follow_saving(const RunStatus& status, Asks& asks) {
  const std::string& saved = status.saving->saved();
  const bool is_saved = std::exchange(saves_, status.saving->saves()) != status.saving->saves();
  if (is_saved) session::keep_recent_file(saved);
  if (saving_ == Saving::tried && is_saved) return leave(waiting_, asks);
  const bool is_cancelled = saving_ == Saving::asked && !parts_.bar.has_dialog();
  if (saving_ == Saving::tried || is_cancelled) saving_ = Saving::none;
  const auto answer = parts_.bar.take_answer();
  if (!answer) return;
  if (*answer == Answer::discard) leave(waiting_, asks);
  if (*answer != Answer::save) return;
  saving_ = saved.empty() ? Saving::asked : Saving::begun;
  if (saved.empty())
    parts_.bar.ask_where_to_save();
  else
    asks.emplace_back(session::SaveShapeAs{saved});
}

void StudioView::go(const Wish& wish, const RunStatus& status, Asks& asks) {
  if (const auto* const there = std::get_if<Go>(&wish))
    if (there->screen != Screen::start && there->screen != Screen::calibration)
      return go_to(there->screen, status, asks);
  if (!timeline().lets(wish)) return;
  if (const auto* const open = std::get_if<Open>(&wish)) {
    if (opens_in_timeline(open->file)) {
      timeline().open(open->file);
      has_chosen_ = true;
      session::keep_recent_file(open->file);
      return go_to(Screen::timeline, status, asks);
    }
  }
  if (!asks_to_save_ || !status.saving->is_modified(status.frame)) return leave(wish, asks);
  waiting_ = wish;
  parts_.bar.ask("the shape of " + file_);
}

void StudioView::go_to(Screen screen, const RunStatus& status, Asks& asks) {
  const bool is_timeline = screen == Screen::timeline;
  // The recording that ends is the one to be shown.
  if (is_timeline && status.facts.recorded) asks.emplace_back(flow::SetRecording{false});
  if (is_timeline && !shows_timeline_) {
    held_ = status.frame.held;
    if (held_) asks.emplace_back(flow::Request::release);
    timeline().enter(recorded_);
  }
  if (!is_timeline && shows_timeline_) {
    parts_.shaping->show_again(status);
    if (std::exchange(held_, false)) asks.emplace_back(flow::Request::grab);
  }
  shows_timeline_ = is_timeline;
  if (!is_timeline) parts_.shaping->window().editor().turn(screen == Screen::puppet);
}

void StudioView::leave(const Wish& wish, Asks& asks) {
  left_for_ = wish;
  is_settled_ = asks_to_save_;
  asks.emplace_back(flow::EndRun{});
}

} // namespace nendo::studio
