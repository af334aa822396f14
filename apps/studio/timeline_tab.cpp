#include "studio/timeline_tab.hpp"

#include <chrono>
#include <filesystem>
#include <system_error>
#include <utility>

#include <nendo/base/text.hpp>

#include "cli/output_place.hpp"
#include "edit/edit_actions.hpp"
#include "studio/waiting.hpp"

namespace nendo::studio {
namespace {

using Frames = Result<std::unique_ptr<takes::TimelineFrames>>;

/// A timeline of the recording, which is in memory until it is saved in `out`.
Frames frames_of_recording(const std::string& file, const std::string& out) {
  edit::MakeOptions options;
  options.take = file;
  options.out = out;
  auto of_take = edit::timeline_of_take(options);
  if (!of_take) return of_take.error();
  return takes::TimelineFrames::make(std::move(of_take->made.timeline), of_take->model);
}

/// Of an earlier timeline of this recording nothing is overwritten.
std::string beside_recording(const std::string& recording) {
  const std::string stem = std::filesystem::path(recording).replace_extension().string();
  const std::string file = stem + std::string(timeline::file_ending);
  std::error_code ignored;
  int number = 1;
  return std::filesystem::exists(file, ignored)
             ? cli::next_free_name(stem, timeline::file_ending, number)
             : file;
}

} // namespace

void TimelineTab::open(const std::string& file) {
  opened_ = Opened{file, ""};
  if (file.empty()) return;
  const bool is_timeline = timeline::is_timeline(file);
  opened_->out = is_timeline ? file : beside_recording(file);
  opened_->reading =
      std::async(std::launch::async, [is_timeline, file, out = opened_->out]() -> Frames {
        return is_timeline ? takes::TimelineFrames::open(file) : frames_of_recording(file, out);
      });
}

void TimelineTab::open(const FirstTimeline& first) {
  opened_ = Opened{first.file, first.out};
  opened_->editing = std::make_unique<edit::WindowEditing>(window_, *first.frames, first.out);
  if (first.key) editing()->session().select(first.key);
  if (first.at_s) editing()->session().seek(*first.at_s);
}

bool TimelineTab::is_modified() const noexcept {
  return editing() != nullptr && editing()->session().history().is_modified();
}

void TimelineTab::enter(const std::string& usual) {
  if (!opened_) open(usual);
  if (editing() != nullptr) editing()->show_again();
}

/// Says what is done, or what there is to do.
Wish TimelineTab::show_reading() {
  const bool is_asked =
      opened_->file.empty()
          ? show_waiting(*window_,
                         "Record while the hands shape: t begins, t again ends.\n"
                         "The recording then opens here, as key poses of both hands.",
                         "Open a recording or a timeline...")
          : show_waiting(*window_, "Reading " + printable(opened_->file));
  if (window_->take_close_request()) return Quit{};
  return is_asked ? Wish{Open{}} : Wish{};
}

Result<Wish> TimelineTab::show_opened() {
  auto& reading = opened_->reading;
  if (reading.valid() && reading.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    auto frames = reading.get();
    if (!frames) return frames.error();
    opened_->editing = std::make_unique<edit::WindowEditing>(window_, **frames, opened_->out);
  }
  if (editing() == nullptr) return show_reading();
  if (const auto shown = editing()->show(); !shown) return shown.error();
  return editing()->quits() ? Wish{Quit{}} : Wish{};
}

Wish TimelineTab::show() {
  bar_.set({Screen::timeline, opened_->file, is_modified(), false});
  const auto wish = show_opened();
  if (wish) return *wish;
  bar_.show_error(wish.error().message);
  opened_.reset();
  return {};
}

bool TimelineTab::has_edits_to_lose() const noexcept {
  return is_modified() && opened_->discarded != editing()->session().history().revision();
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
  bar_.ask("the changes to " + printable(opened_->out));
  return false;
}

Wish TimelineTab::take_settled() {
  if (!is_wish(waiting_)) return {};
  const auto answer = bar_.take_answer();
  if (!answer) return {};
  const Wish wish = std::exchange(waiting_, {});
  if (editing() == nullptr) return wish; // it has failed meanwhile
  edit::EditSession& session = editing()->session();
  viewer::EditActions save;
  save.commands = {viewer::EditCommand::save};
  if (*answer == Answer::save) session.handle(save);
  if (*answer == Answer::discard) opened_->discarded = session.history().revision();
  return has_edits_to_lose() ? Wish{} : wish;
}

} // namespace nendo::studio
