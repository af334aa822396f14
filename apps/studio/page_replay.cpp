#include "studio/page_replay.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include <nendo/base/text.hpp>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "commands/commands.hpp"
#include "session/views.hpp"

namespace nendo::studio {
namespace {

using namespace std::chrono_literals;

template <class T>
bool is_ready(const std::future<T>& future) {
  return future.valid() && future.wait_for(0s) == std::future_status::ready;
}

/// The result of a reading that was left, in place of a take that would only need memory.
Error reading_left() {
  return {Errc::failed, "the page shows something else"};
}

} // namespace

Result<PageReplay::Opened> PageReplay::opened(const std::string& file,
                                              const std::stop_token& stop) {
  auto take = takes::read_take(file);
  if (stop.stop_requested()) return reading_left();
  if (!take) return take.error();
  if (!take->open)
    return Error{Errc::bad_input, printable(file) + ": no recording, and no timeline"};
  auto frames = take->open();
  if (!frames) return frames.error();
  if (stop.stop_requested()) return reading_left();
  return Opened{*std::move(take), *std::move(frames)};
}

PageReplay::PageReplay(web::Server& server, LeftReadings& left, std::string file, std::size_t most)
    : server_(server), left_readings_(left), file_(std::move(file)), most_(most) {}

void PageReplay::begin_reading() {
  if (opened_ || reading_.valid() || !left_readings_.have_ended()) return;
  reading_ = std::async(std::launch::async,
                        [name = file_, stop = stop_.get_token()] { return opened(name, stop); });
}

PageReplay::~PageReplay() {
  stop_.request_stop();
  left_readings_.add(std::move(reading_));
  left_readings_.add(std::move(rewinding_));
  server_.end_beside();
}

/// Begins to show the frames' present version of the model.
Result<void> PageReplay::present() {
  takes::FrameSource& frames = *opened_->frames;
  version_ = frames.frame().model;
  const deform::BlockLayout& layout = frames.layout(version_);
  if (auto fine = session::check_for_browsers(layout.vertex_count(), most_); !fine) return fine;
  stream_ = std::make_shared<web::FrameStream>(layout, flow::FrameCapacity{});
  std::array<flow::HandInput, 2> hands;
  hands[0].side = hands[0].first.side = Side::left;
  hands[1].side = hands[1].first.side = Side::right;
  server_.present_beside(stream_,
                         web::model_message(layout, frames.model(version_), hands,
                                            {cli::short_name(file_), frames.rate_hz(),
                                             frames.frame().units_per_metre}),
                         web::pictures_of(frames.model(version_)));
  return {};
}

/// Each frame is a jump to its whole shape, because not all frames are shown.
Result<void> PageReplay::show() {
  const flow::Frame& frame = opened_->frames->frame();
  if (!stream_ || frame.model != version_)
    if (auto presented = present(); !presented) return presented;
  shown_.settings.mode = flow::Mode::type2; // whose base is the shape
  shown_.hands = frame.hands;
  shown_.units_per_metre = frame.units_per_metre;
  shown_.held = false;
  shown_.shape = frame.shape;
  ++shown_.shape_jumps;
  return {};
}

void PageReplay::go_to(double time_s) {
  time_s_ = std::clamp(time_s, 0.0, opened_->take.duration_s);
  if (rewinding_.valid() || time_s_ >= opened_->frames->time_s()) return;
  rewinding_ =
      std::async(std::launch::async, [open = opened_->take.open, stop = stop_.get_token()] {
        auto frames = open();
        return stop.stop_requested() ? reading_left() : std::move(frames);
      });
}

Error PageReplay::no_frame() const {
  return {Errc::bad_input, printable(file_) + ": has no frame; record again"};
}

Result<void> PageReplay::play_on() {
  if (is_ready(rewinding_)) {
    auto frames = rewinding_.get();
    if (!frames) return frames.error();
    opened_->frames = *std::move(frames);
    if (!opened_->frames->next()) return no_frame();
    if (const auto shown = show(); !shown) return shown;
  }
  const HostTime now = HostClock::now();
  const double elapsed_s = to_seconds(now - std::exchange(updated_, now));
  if (rewinding_.valid()) return {};
  if (plays_) time_s_ = std::min(time_s_ + elapsed_s, opened_->take.duration_s);
  if (time_s_ >= opened_->take.duration_s) plays_ = false;
  takes::FrameSource& frames = *opened_->frames;
  const bool is_behind = frames.time_s() < time_s_;
  while (frames.time_s() < time_s_ && HostClock::now() - now < 20ms && frames.next()) {
  }
  if (is_behind)
    if (const auto shown = show(); !shown) return shown;
  ++shown_.ticks_run;
  stream_->show(shown_); // also while it pauses: a client may need the shape
  return {};
}

void PageReplay::take_controls(web::PageForm& form) {
  const commands::Row& play = commands::row_of(commands::EditCommand::play);
  const commands::Row& to_begin = commands::row_of(commands::EditCommand::to_begin);
  const double duration_s = opened_->take.duration_s;
  form.lines_of(0);
  if (form.button(to_begin.button, to_begin.help)) go_to(0.0);
  if (form.button(plays_ ? play.button_on : play.button, play.help, Form::Look::chosen)) {
    if (!plays_ && time_s_ >= duration_s) go_to(0.0);
    plays_ = !plays_;
  }
  auto time_s = static_cast<float>(time_s_);
  if (form.number("time", "The play head.", time_s, 0.0F, static_cast<float>(duration_s), "s", 2))
    go_to(static_cast<double>(time_s));
}

Result<Wish> PageReplay::update(web::PageForm& form) {
  form.part("timeline");
  if (file_.empty()) {
    form.text("Record while the hands shape: t begins, t again ends. The recording then opens "
              "here.");
    form.lines_of(0);
    if (form.button("Open a recording or a timeline...", "")) return Wish{Open{}};
    return Wish{};
  }
  begin_reading();
  if (is_ready(reading_)) {
    auto opened = reading_.get();
    if (!opened) return opened.error();
    opened_ = *std::move(opened);
    updated_ = HostClock::now();
    if (!opened_->frames->next()) return no_frame();
    if (const auto shown = show(); !shown) return shown.error();
  }
  if (!opened_) {
    form.text("Reading " + printable(file_));
    return Wish{};
  }
  if (const auto played = play_on(); !played) return played.error();
  take_controls(form);
  return Wish{};
}

} // namespace nendo::studio
