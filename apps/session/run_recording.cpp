#include "session/run_recording.hpp"

#include <filesystem>
#include <utility>

#include <nendo/deform/simd.hpp>
#include <nendo/version.hpp>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "cli/output_place.hpp"
#include "cli/quantities.hpp"
#include "session/place_loop.hpp"

namespace nendo::session {
Result<void> RecordingOptions::check(const std::string& out, flow::SwitchAction action) {
  if (!keep_last.empty()) {
    constexpr double max_s = 3600.0;
    const auto seconds = cli::parse_duration(keep_last, "--keep-last");
    if (!seconds) return seconds.error();
    if (*seconds > max_s)
      return Error{Errc::usage,
                   "--keep-last " + keep_last + ": use at most 1h; --record keeps everything"};
    keep_last_s = *seconds;
  }
  on = !file.empty();
  kept_stem = std::filesystem::path(out).replace_extension().string();
  if (action == flow::SwitchAction::keep && keep_last_s <= 0.0)
    return Error{Errc::usage, "--switch keep: needs --keep-last, e.g. --keep-last 60s"};
  return cli::check_new_recording("--record", file);
}

void add_recording_options(const cli::Command& whole, RecordingOptions& options) {
  cli::Command command = whole.under("Recording");
  command.add_option("--record", options.file,
                     "Record all input in this file, for `nendo replay` and as a glove");
  command.add_option(
      "--keep-last", options.keep_last,
      "Keep this time in memory, e.g. 60s; --switch keep writes it beside --out, and "
      "so does a crash");
}

recording::Setup begin_setup(const std::vector<gloves::OpenHand>& hands,
                             const std::string& wearer) {
  recording::Setup setup = recording::begin_setup("nendo " NENDO_VERSION);
  setup.wearer = wearer;
  for (const auto& hand : hands) {
    setup.gloves.push_back(hand.glove->info());
    if (!hand.wrist) continue;
    const driver::TrackerStation& station = hand.wrist->station;
    setup.trackers.push_back({hand.side, station.station, station.tracker->info()});
    setup.trackers.back().info.source = station.source;
  }
  return setup;
}

std::vector<driver::RecordCounts> counts_of(const std::vector<gloves::OpenHand>& hands) {
  std::vector<driver::RecordCounts> counts;
  counts.reserve(hands.size());
  for (const auto& hand : hands)
    counts.push_back(driver::counts_of(hand.glove->stats()));
  return counts;
}

flow::InputLog* RunRecorder::first_log() {
  if (options_.recording.wanted()) log_ = std::make_unique<flow::InputLog>();
  return log_.get();
}

std::string RunRecorder::next_name() {
  const RecordingOptions& asked = options_.recording;
  const std::string first = asked.file.empty() ? asked.kept_stem + ".nendo" : asked.file;
  std::error_code ignored;
  std::string name = first;
  while (std::filesystem::exists(name, ignored))
    name = cli::next_free_name(first, number_);
  return name;
}

recording::Setup RunRecorder::setup_now() const {
  recording::Setup setup = begin_setup(hands_, options_.calibration.users());
  setup.hands = placed_.setup.inputs;
  if (options_.over) {
    const auto& gloves = options_.over->take.setup.gloves;
    setup.gloves.insert(setup.gloves.begin(), gloves.begin(), gloves.end());
    setup.trackers = options_.over->take.setup.trackers; // a take's wrists are its own
  }
  setup.loop = recording::LoopSetup{cli::absolute_name(options_.mesh),
                                    recording::sum_of(model_.vertices),
                                    placed_.setup.placement,
                                    placed_.setup.options,
                                    std::string(deform::simd_names().front()),
                                    {}};
  setup.loop->is_tracked = !setup.trackers.empty();
  if (const auto& rig = placed_.setup.options.rig) {
    setup.loop->puppet.text = rig->puppet().text;
    setup.loop->puppet.starts = rig->starts();
  }
  if (options_.over) { // its model may have been subdivided and shaped before it began
    const recording::LoopSetup& taken = *options_.over->take.setup.loop;
    setup.loop->mesh_sum = taken.mesh_sum;
    setup.loop->origins = taken.origins;
    setup.loop->rest = taken.rest;
  }
  return setup;
}

Result<void> RunRecorder::begin() {
  if (!log_) return {};
  to_file_ = options_.recording.on;
  // The loop takes all that came since the gloves were started.
  return begin(setup_now(), Counts(placed_.setup.inputs.size()));
}

RunRecorder::Counts RunRecorder::counts() const {
  Counts counts = counts_of(hands_);
  if (!options_.over) return counts;
  const Counts& of_take = options_.over->take.sent;
  counts.insert(counts.begin(), of_take.begin(), of_take.end());
  return counts;
}

Result<void> RunRecorder::begin(const recording::Setup& setup, const Counts& before) {
  const RecordingOptions& asked = options_.recording;
  const std::string name = to_file_ ? next_name() : "";
  outcomes_.push_back({name, std::nullopt});
  recording::RecorderOptions wanted;
  wanted.file = name;
  wanted.keep_last = from_seconds(asked.keep_last_s);
  wanted.kept_stem = asked.kept_stem;
  wanted.keep_on_switch = options_.loop.switch_action == flow::SwitchAction::keep;
  wanted.report = cli::note;
  wanted.sent = [this, before] {
    auto counts = this->counts();
    for (std::size_t at = 0; at < counts.size(); ++at)
      counts[at] = driver::since(before[at], counts[at]);
    return counts;
  };
  auto recorder = recording::Recorder::begin(setup, *log_, std::move(wanted));
  if (!recorder) return recorder.error();
  recorder_ = *std::move(recorder);
  return {};
}

void RunRecorder::set_file(bool on, const flow::Frame& frame) {
  if (on == to_file_) return;
  next_to_file_ = on;
  const bool any = on || options_.recording.keep_last_s > 0.0;
  next_log_ = any ? std::make_unique<flow::InputLog>() : nullptr;
  counts_ = counts();
  is_changing_ = true;
  placed_.loop->changes().change_log(next_log_.get(), frame.shape);
}

std::optional<Report> RunRecorder::follow() {
  if (!is_changing_) return std::nullopt;
  const auto state = placed_.loop->changes().take_state();
  if (!state) return std::nullopt;
  is_changing_ = false;
  const deform::BlockLayout& layout = placed_.loop->changes().newest_model().layout();
  deform::Points vertices;
  layout.unpack(state->shape, vertices);
  end_with(recording::sum_of(vertices));
  log_ = std::move(next_log_);
  to_file_ = next_to_file_;
  if (!log_) return std::nullopt;
  recording::Setup setup = setup_now();
  recording::continue_from(*state, layout, setup);
  const auto begun = begin(setup, counts_);
  if (begun) return std::nullopt;
  outcomes_.pop_back();
  to_file_ = false;
  if (keeps_last_minute() && begin(setup, counts_))
    return Report(begun.error().message + "; the run continues, and is kept in memory only", true);
  next_log_.reset();
  is_changing_ = true;
  placed_.loop->changes().change_log(nullptr, state->shape);
  return Report(begun.error().message + "; the run continues without a recording", true);
}

bool RunRecorder::keeps_last_minute() const noexcept {
  return options_.recording.keep_last_s > 0.0;
}

void RunRecorder::add_puppet(std::uint32_t number, const puppet::Rig& rig) {
  if (recorder_) recorder_->add_puppet(number, {rig.puppet().text, rig.starts()});
}

void RunRecorder::save_last_minute() noexcept {
  if (keeps_last_minute() && recorder_) recorder_->save_last_minute();
}

void RunRecorder::end(const deform::Points& shape) {
  // A change that the loop made in its last tick ends one recording and begins another.
  if (const auto message = follow()) cli::note(message->text);
  end_with(recording::sum_of(shape));
}

void RunRecorder::end_with(const recording::ShapeSum& shape) {
  if (!recorder_) return;
  const auto recorded = recorder_->end(shape);
  if (recorded) { // otherwise the error was reported at once
    outcomes_.back().recorded = *recorded;
    if (!outcomes_.back().file.empty()) last_file_ = outcomes_.back().file;
  }
  recorder_.reset();
}

} // namespace nendo::session
