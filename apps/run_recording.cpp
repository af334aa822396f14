#include "run_recording.hpp"

#include <filesystem>

#include <nendo/deform/simd.hpp>

#include "cli.hpp"
#include "durations.hpp"
#include "place_loop.hpp"

namespace nendo::app {

Result<void> RecordingOptions::check(const std::string& out, flow::SwitchAction action) {
  if (!keep_last.empty()) {
    constexpr double most_s = 3600.0;
    const auto seconds = parse_duration(keep_last, "--keep-last");
    if (!seconds) return seconds.error();
    if (*seconds > most_s)
      return Error{Errc::usage,
                   "--keep-last " + keep_last + ": an hour at most; --record keeps all"};
    keep_last_s = *seconds;
    kept_stem = std::filesystem::path(out).replace_extension().string();
  }
  if (action == flow::SwitchAction::keep && keep_last_s <= 0.0)
    return Error{Errc::usage, "--switch keep: say how much with --keep-last, e.g. 60s"};
  std::error_code ignored;
  if (!file.empty() && std::filesystem::exists(file, ignored)) {
    return Error{Errc::failed, "--record " + file +
                                   ": is there already, and no recording is written over; name "
                                   "another file or move it away"};
  }
  return {};
}

void add_recording_options(Command& command, RecordingOptions& options) {
  command
      .add_option("--record", options.file,
                  "Records all that comes in to this file, for nendo replay and as a glove")
      .under("Recording");
  command
      .add_option("--keep-last", options.keep_last,
                  "Keeps so much in memory, e.g. 60s, written by --switch keep and when the "
                  "program crashes, beside --out")
      .under("Recording");
}

recording::Setup begin_setup(const std::vector<OpenHand>& hands, const std::string& wearer) {
  recording::Setup setup = recording::begin_setup("nendo " NENDO_VERSION);
  setup.wearer = wearer;
  for (const auto& hand : hands)
    setup.gloves.push_back(hand.glove->info());
  return setup;
}

RunRecorder::RunRecorder(const RecordingOptions& options) {
  if (options.wanted()) tape_.emplace();
}

Result<void> RunRecorder::begin(const RunOptions& options, const PlacedSetup& placed,
                                const std::vector<OpenHand>& hands, const deform::Mesh& model) {
  if (!tape_) return {};
  recording::Setup setup = begin_setup(hands, options.calibration.user);
  for (std::size_t at = 0; at < hands.size(); ++at) {
    setup.hands.push_back(recording::hand_setup(placed.inputs[at],
                                                options.length.size(hands[at].known.own.size),
                                                options.length.size(hands[at].known.swapped.size)));
  }
  std::error_code ignored;
  setup.loop = recording::LoopSetup{std::filesystem::absolute(options.mesh, ignored).string(),
                                    recording::sum_of(model.vertices), placed.placement,
                                    placed.options, std::string(deform::simd_names().front())};
  recording::RecorderOptions wanted;
  wanted.file = options.recording.file;
  wanted.keep_last = std::chrono::duration_cast<HostClock::duration>(
      std::chrono::duration<double>(options.recording.keep_last_s));
  wanted.kept_stem = options.recording.kept_stem;
  wanted.keep_on_switch = options.loop.switch_action == flow::SwitchAction::keep;
  wanted.tell = note;
  auto recorder = recording::Recorder::begin(setup, *tape_, std::move(wanted));
  if (!recorder) return recorder.error();
  recorder_ = *std::move(recorder);
  keeps_ = options.recording.keep_last_s > 0.0;
  return {};
}

void RunRecorder::keep() noexcept {
  if (keeps_) recorder_->keep();
}

RecordingOutcome RunRecorder::end(const deform::Mesh& shape) {
  keeps_ = false;
  if (!recorder_) return {};
  const auto recorded = recorder_->end(recording::sum_of(shape.vertices));
  if (!recorded) return {std::nullopt, true}; // what it is was told at once
  return {*recorded, false};
}

} // namespace nendo::app
