#include "export/chosen_frames.hpp"

#include <algorithm>
#include <string>

namespace nendo::exporting {
namespace {

constexpr double max_s = 1e7; // as long as a take may be

Error too_many() {
  return {Errc::usage, "--rate, --from, --to: that would be more than " +
                           std::to_string(max_export_frames) +
                           " frames; export a part, or fewer a second"};
}

} // namespace

Result<void> check(const Choice& choice) {
  const double to_s = choice.to_s.value_or(max_s);
  if (!(choice.from_s >= 0.0 && choice.from_s < to_s && to_s <= max_s))
    return Error{Errc::usage, "--from, --to: use seconds from the beginning, --from before --to"};
  if (choice.rate_hz && !(*choice.rate_hz > 0.0 && *choice.rate_hz <= max_export_rate_hz))
    return Error{Errc::usage, "--rate: use frames per second above 0 and up to 10000"};
  return {};
}

Result<ChosenFrames> ChosenFrames::make(takes::FrameSource& source, const Choice& choice) {
  if (const auto fine = check(choice); !fine) return fine.error();
  ChosenFrames chosen(source, choice);
  const double end_s = std::min(choice.to_s.value_or(max_s), source.duration_s());
  while ((chosen.is_ahead_ = source.next()) && source.time_s() < choice.from_s) {
    if (choice.stop != nullptr && *choice.stop) break;
  }
  if (!chosen.is_ahead_ || source.time_s() > choice.to_s.value_or(max_s)) {
    return Error{Errc::bad_input, "there is no frame from --from to --to; the take lasts " +
                                      std::to_string(source.duration_s()) + " s"};
  }
  chosen.first_s_ = source.time_s();
  chosen.even_ = choice.rate_hz.has_value();
  if (!chosen.even_) return chosen;
  const double rate_hz = *choice.rate_hz;
  constexpr double rounding = 1e-6; // of a period
  const double periods = std::max(0.0, (end_s - chosen.first_s_) * rate_hz + rounding);
  if (!(periods < static_cast<double>(max_export_frames))) return too_many();
  chosen.count_ = static_cast<std::uint64_t>(periods) + 1;
  return chosen;
}

Result<void> ChosenFrames::check_stop() const {
  if (choice_.stop == nullptr || !*choice_.stop) return {};
  return Error{Errc::failed, "stopped before the end"};
}

Result<bool> ChosenFrames::next() {
  if (const auto fine = check_stop(); !fine) return fine.error();
  if (even_) {
    if (made_ == *count_) return false;
    time_s_ = first_s_ + static_cast<double>(made_) / *choice_.rate_hz;
    hold_nearest(time_s_);
  } else {
    if (!is_ahead_ && !source_->next()) return false;
    is_ahead_ = false;
    if (source_->time_s() > choice_.to_s.value_or(max_s)) return false;
    if (made_ == max_export_frames) return too_many();
    time_s_ = source_->time_s();
  }
  ++made_;
  return true;
}

Exported ChosenFrames::report() const {
  Exported report{{}, made_, first_s_, time_s_};
  report.rate_hz = choice_.rate_hz;
  report.exact = source_->is_exact();
  return report;
}

/// Whether the source's frame is nearer to the moment than the one that is held. Where frames are
/// missing the one before stays: none comes early by more than three quarters of a period, which no
/// nearest one does between frames that are less than one and a half apart.
bool ChosenFrames::is_nearer(double moment_s) const {
  constexpr double max_early = 0.75;
  const double early_s = source_->time_s() - moment_s;
  if (early_s <= 0.0) return true;
  return early_s <= max_early / source_->rate_hz() && early_s < moment_s - held_s_;
}

void ChosenFrames::hold_nearest(double moment_s) {
  while (is_ahead_ && is_nearer(moment_s)) {
    const flow::Frame& frame = source_->frame();
    if (made_ == 0 || frame.puppet != held_.puppet || frame.model != held_.model)
      puppet_ = source_->puppet();
    held_ = source_->frame();
    held_s_ = source_->time_s();
    is_ahead_ = source_->next();
  }
}

Result<Exported> export_to_one_file(ChosenFrames& frames, const std::filesystem::path& path,
                                    const PutFrame& put, const PutFrame& put_end) {
  auto file = FileReplacement::begin(path);
  if (!file) return file.error();
  const auto done = frames.for_each([&] { return put(*file); });
  if (!done) return done.error();
  if (put_end)
    if (const auto ended = put_end(*file); !ended) return ended.error();
  if (const auto finished = file->finish(); !finished) return finished.error();
  Exported report = frames.report();
  report.files = {path.string()};
  report.bytes = file->size();
  return report;
}

} // namespace nendo::exporting
