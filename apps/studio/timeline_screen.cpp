#include "studio/timeline_screen.hpp"

#include <chrono>
#include <filesystem>
#include <system_error>
#include <utility>

#include <nendo/base/text.hpp>

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
  std::error_code ignored;
  std::string file = stem + std::string(timeline::file_ending);
  for (int number = 2; std::filesystem::exists(file, ignored); ++number)
    file = stem + "-" + std::to_string(number) + std::string(timeline::file_ending);
  return file;
}

} // namespace

TimelineScreen::TimelineScreen(std::shared_ptr<viewer::SceneWindow> window, std::string file)
    : window_(std::move(window)), file_(std::move(file)) {
  if (file_.empty()) return;
  const bool is_timeline = timeline::is_timeline(file_);
  out_ = is_timeline ? file_ : beside_recording(file_);
  reading_ = std::async(std::launch::async, [is_timeline, name = file_, out = out_]() -> Frames {
    return is_timeline ? takes::TimelineFrames::open(name) : frames_of_recording(name, out);
  });
}

TimelineScreen::TimelineScreen(std::shared_ptr<viewer::SceneWindow> window,
                               const FirstTimeline& first)
    : window_(std::move(window)), file_(first.file), out_(first.out),
      editing_(std::make_unique<edit::WindowEditing>(window_, *first.frames, first.out)) {
  if (first.key) editing_->session().select(first.key);
  if (first.at_s) editing_->session().seek(*first.at_s);
}

bool TimelineScreen::is_modified() const noexcept {
  return editing_ && editing_->session().history().is_modified();
}

std::uint64_t TimelineScreen::revision() const noexcept {
  return editing_ ? editing_->session().history().revision() : 0;
}

void TimelineScreen::save() {
  viewer::EditActions actions;
  actions.commands.push_back(viewer::EditCommand::save);
  if (editing_) editing_->session().handle(actions);
}

void TimelineScreen::show_again() {
  if (editing_) editing_->show_again();
}

/// Says what is done, or what there is to do.
Wish TimelineScreen::show_reading() {
  const bool is_asked =
      file_.empty() ? show_waiting(*window_,
                                   "Record while the hands shape: t begins, t again ends.\n"
                                   "The recording then opens here, as key poses of both hands.",
                                   "Open a recording or a timeline...")
                    : show_waiting(*window_, "Reading " + printable(file_));
  if (window_->take_close_request()) return Quit{};
  return is_asked ? Wish{Open{}} : Wish{};
}

Result<Wish> TimelineScreen::show() {
  if (reading_.valid() && reading_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    auto frames = reading_.get();
    if (!frames) return frames.error();
    editing_ = std::make_unique<edit::WindowEditing>(window_, **frames, out_);
  }
  if (!editing_) return show_reading();
  if (const auto shown = editing_->show(); !shown) return shown.error();
  return editing_->quits() ? Wish{Quit{}} : Wish{};
}

} // namespace nendo::studio
