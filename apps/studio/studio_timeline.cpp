#include "studio/studio_timeline.hpp"

#include <chrono>
#include <filesystem>
#include <system_error>
#include <utility>

#include <nendo/base/text.hpp>

#include "cli/output_place.hpp"
#include "edit/edit_actions.hpp"
#include "studio/opened_files.hpp"
#include "timeline/edit.hpp"

namespace nendo::studio {
namespace {

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

StudioTimeline::Frames StudioTimeline::read_file(const std::string& file, const std::string& out) {
  if (timeline::is_timeline(file)) return takes::TimelineFrames::open(file);
  edit::MakeOptions options;
  options.take = file;
  options.out = out;
  auto of_take = edit::timeline_of_take(options);
  if (!of_take) return of_take.error();
  return takes::TimelineFrames::make(std::move(of_take->made.timeline), of_take->model);
}

StudioTimeline::~StudioTimeline() {
  remove_sent(waiting_);
  close();
  for (Left& left : left_)
    end(left);
}

void StudioTimeline::open(const Open& wanted) {
  close();
  file_ = wanted.file;
  was_sent_ = wanted.was_sent;
  if (!is_open()) return;
  out_ = timeline::is_timeline(file_) ? file_ : beside_recording(file_);
  begin_reading();
}

void StudioTimeline::open(const FirstTimeline& first) {
  close();
  file_ = first.file;
  out_ = first.out;
  begin(*first.frames);
  if (first.key) session_->select(first.key);
  if (first.at_s) session_->seek(*first.at_s);
}

/// The destructor of a reading waits for its end, and the user would wait as well.
void StudioTimeline::close() {
  if (reading_.valid()) left_.push_back({std::move(reading_), {file_, was_sent_}});
  session_.reset();
  model_.reset();
  file_.clear();
  out_.clear();
  was_sent_ = false;
  discarded_.reset();
}

bool StudioTimeline::is_ready(const Reading& reading) {
  return reading.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

/// Waits for the end of the reading.
void StudioTimeline::end(Left& left) {
  if (!left.reading.get()) remove_sent(left.file);
}

void StudioTimeline::follow_left() {
  for (Left& left : left_)
    if (is_ready(left.reading)) end(left);
  std::erase_if(left_, [](const Left& left) { return !left.reading.valid(); });
}

/// Someone who opens and leaves files quickly must not fill the memory.
void StudioTimeline::begin_reading() {
  follow_left();
  if (left_.size() > 1) return;
  reading_ = std::async(std::launch::async, read_file_, file_, out_);
}

void StudioTimeline::begin(takes::TimelineFrames& frames) {
  session_ = std::make_unique<edit::EditSession>(frames.player().timeline(), frames.model(0), out_);
  model_ = frames.player().model(0);
}

Result<edit::EditSession*> StudioTimeline::read() {
  follow_left();
  if (session_ || !is_open()) return session_.get();
  if (!reading_.valid()) begin_reading();
  if (!reading_.valid() || !is_ready(reading_)) return nullptr;
  const Frames frames = reading_.get();
  if (frames) {
    begin(**frames);
    return session_.get();
  }
  remove_sent(Open{file_, was_sent_});
  close();
  return frames.error();
}

std::string StudioTimeline::waiting_words() const {
  if (is_open()) return "Reading " + printable(file_);
  return "Record while the hands shape: t begins, t again ends.\n"
         "The recording then opens here, as key poses of both hands.";
}

bool StudioTimeline::is_modified() const noexcept {
  return session_ != nullptr && session_->history().is_modified();
}

bool StudioTimeline::is_in_use() const {
  if (!session_) return false;
  session_->advance(0.0); // while other screens are shown, nothing else notices an export's end
  return is_modified() || session_->view().facts.exporting;
}

bool StudioTimeline::has_edits_to_lose() const noexcept {
  return is_modified() && discarded_ != session_->history().revision();
}

bool StudioTimeline::lets(const Wish& wish) {
  const auto* const file = std::get_if<Open>(&wish);
  const bool loses =
      std::holds_alternative<Quit>(wish) || (file != nullptr && opens_in_timeline(file->file));
  if (!loses || !has_edits_to_lose()) return true;
  remove_sent(std::exchange(waiting_, wish));
  return false;
}

std::string StudioTimeline::unsaved() const {
  return "the changes to " + printable(out_);
}

Result<Wish> StudioTimeline::settle(Answer answer) {
  const Wish wish = std::exchange(waiting_, {});
  forms::EditActions save;
  save.commands = {forms::EditCommand::save};
  if (answer == Answer::save && session_) session_->handle(save);
  if (answer == Answer::discard && session_) discarded_ = session_->history().revision();
  if (answer != Answer::stay && !has_edits_to_lose()) return wish;
  remove_sent(wish);
  if (answer == Answer::save) return Error{Errc::failed, session_->view().message};
  return Wish{};
}

} // namespace nendo::studio
