#include "session/run_recording.hpp"

#include <filesystem>
#include <utility>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/simd.hpp>
#include <nendo/driver/record_counts.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "cli/quantities.hpp"
#include "session/place_loop.hpp"

namespace nendo::session {
namespace {

std::filesystem::path model_beside(const std::string& recording) {
  return std::filesystem::path(recording).replace_extension(".model.obj");
}

} // namespace

Result<void> RecordingOptions::check(const std::string& out, flow::SwitchAction action) {
  if (!keep_last.empty()) {
    constexpr double most_s = 3600.0;
    const auto seconds = cli::parse_duration(keep_last, "--keep-last");
    if (!seconds) return seconds.error();
    if (*seconds > most_s)
      return Error{Errc::usage,
                   "--keep-last " + keep_last + ": an hour at most; --record keeps all"};
    keep_last_s = *seconds;
  }
  on = !file.empty();
  kept_stem = std::filesystem::path(out).replace_extension().string();
  if (action == flow::SwitchAction::keep && keep_last_s <= 0.0)
    return Error{Errc::usage, "--switch keep: say how much with --keep-last, e.g. 60s"};
  std::error_code ignored;
  if (on && std::filesystem::exists(file, ignored)) {
    return Error{Errc::failed, "--record " + file +
                                   ": is there already, and no recording is written over; name "
                                   "another file or move it away"};
  }
  return {};
}

void add_recording_options(cli::Command& command, RecordingOptions& options) {
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

recording::Setup begin_setup(const std::vector<gloves::OpenHand>& hands,
                             const std::string& wearer) {
  recording::Setup setup = recording::begin_setup("nendo " NENDO_VERSION);
  setup.wearer = wearer;
  for (const auto& hand : hands)
    setup.gloves.push_back(hand.glove->info());
  return setup;
}

std::vector<driver::RecordCounts> counts_of(const std::vector<gloves::OpenHand>& hands) {
  std::vector<driver::RecordCounts> counts;
  for (const auto& hand : hands)
    counts.push_back(driver::counts_of(hand.glove->stats()));
  return counts;
}

flow::InputLog* RunRecorder::input_log_for(const RecordingOptions& options) {
  input_log_ = options.wanted() ? std::make_unique<flow::InputLog>() : nullptr;
  return input_log_.get();
}

std::string RunRecorder::next_name(const RecordingOptions& options, bool with_model) {
  const std::string first = options.file.empty() ? options.kept_stem + ".nendo" : options.file;
  std::error_code ignored;
  std::string name = first;
  while (std::filesystem::exists(name, ignored) ||
         (with_model && std::filesystem::exists(model_beside(name), ignored)))
    name = cli::next_free_name(first, number_);
  return name;
}

Result<void> RunRecorder::begin(const RunOptions& options, const PlacedSetup& placed,
                                const std::vector<gloves::OpenHand>& hands,
                                const deform::Mesh& model) {
  // The first loop takes all that came since the gloves were started; a later one begins anew.
  const auto before = std::exchange(first_loop_, false)
                          ? std::vector<driver::RecordCounts>(hands.size())
                          : counts_of(hands);
  if (!input_log_) return {};
  const auto& asked = options.recording;
  const auto sum = recording::sum_of(model.vertices);
  const bool with_model = sum != loaded_;
  const std::string name = next_name(asked, with_model);
  outcomes_.push_back({asked.on ? name : "", std::nullopt});
  recording::Setup setup = begin_setup(hands, options.calibration.user);
  setup.hands = placed.inputs;
  // Whoever replays the loop needs the model that it began with.
  const auto mesh = with_model ? model_beside(name) : std::filesystem::path(options.mesh);
  if (with_model)
    if (const auto written = deform::write_mesh(mesh, model); !written) return written.error();
  setup.loop = recording::LoopSetup{std::filesystem::absolute(mesh).string(), sum, placed.placement,
                                    placed.options, std::string(deform::simd_names().front())};
  recording::RecorderOptions wanted;
  if (asked.on) wanted.file = name;
  wanted.keep_last = from_seconds(asked.keep_last_s);
  wanted.kept_stem = asked.kept_stem;
  wanted.keep_on_switch = options.loop.switch_action == flow::SwitchAction::keep;
  wanted.report = cli::note;
  wanted.sent = [&hands, before] {
    auto counts = counts_of(hands);
    for (std::size_t at = 0; at < counts.size(); ++at)
      counts[at] = driver::since(before[at], counts[at]);
    return counts;
  };
  auto recorder = recording::Recorder::begin(setup, *input_log_, std::move(wanted));
  if (!recorder) return recorder.error();
  recorder_ = *std::move(recorder);
  keeps_last_minute_ = asked.keep_last_s > 0.0;
  return {};
}

void RunRecorder::save_last_minute() noexcept {
  if (keeps_last_minute_) recorder_->save_last_minute();
}

void RunRecorder::end(const deform::Mesh& shape) {
  keeps_last_minute_ = false;
  if (!recorder_) return;
  const auto recorded = recorder_->end(recording::sum_of(shape.vertices));
  if (recorded) outcomes_.back().recorded = *recorded; // otherwise the error was reported at once
  recorder_.reset();
}

} // namespace nendo::session
