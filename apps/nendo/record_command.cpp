// nendo record: records what gloves, and trackers at wrists, send.

#include <thread>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/base/text.hpp>
#include <nendo/driver/record_counts.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "cli/print.hpp"
#include "cli/quantities.hpp"
#include "gloves/glove_json.hpp"
#include "nendo/commands.hpp"
#include "session/open_hands.hpp"
#include "session/run_recording.hpp"

namespace nendo::app::record_command {
namespace {

struct Options {
  std::vector<std::string> gloves;
  gloves::WristOptions wrists;
  std::string out;
  double duration_s = 0.0; ///< 0: until a stop signal
  gloves::CalibrationOptions calibration;
  gloves::HandLength length;
  bool json = false;
};

Result<void> check(Options& options) {
  if (auto fine = session::check_count(options.gloves); !fine) return fine;
  if (auto fine = cli::check_duration(options.duration_s); !fine) return fine;
  if (auto fine = options.length.check(); !fine) return fine;
  if (auto fine = gloves::check(options.calibration); !fine) return fine;
  return cli::check_new_recording("--out", options.out);
}

Result<std::vector<gloves::OpenHand>> open_gloves(const Options& options) {
  auto hands = session::open_each(options.gloves);
  if (!hands) return hands;
  if (const auto wrists = gloves::open_wrists(*hands, options.wrists); !wrists)
    return wrists.error();
  if (const auto started = gloves::start(*hands); !started) return started.error();
  if (const auto done = gloves::calibrate(*hands, options.calibration, options.length); !done)
    return done.error();
  return hands;
}

recording::Setup setup_for(const std::vector<gloves::OpenHand>& hands, const Options& options) {
  recording::Setup setup = session::begin_setup(hands, options.calibration.users());
  for (const auto& hand : hands) {
    setup.hands.push_back({nullptr, hand.side, hand.wearer, hand.first});
    if (hand.wrist) setup.hands.back().wrist_source = {nullptr, hand.wrist->tracking};
  }
  return setup;
}

/// The recorded poses of each hand's wrist.
using PoseCounts = std::vector<std::uint64_t>;

/// Copies samples and poses from the rings to the input log, until the recording is over or the
/// gloves can send nothing more.
PoseCounts copy_samples(std::vector<gloves::OpenHand>& hands, flow::InputLog& input_log,
                        double duration_s) {
  const HostTime start = HostClock::now();
  PoseCounts poses(hands.size());
  const auto drain = [&] {
    for (std::size_t at = 0; at < hands.size(); ++at) {
      const Side side = hands[at].side;
      if (hands[at].wrist)
        poses[at] += hands[at].wrist->ring->drain(
            [&](const PoseSample& pose) noexcept { input_log.pose(side, pose); });
      hands[at].ring->drain([&](const GloveSample& sample) noexcept {
        input_log.sample(static_cast<std::uint8_t>(at), sample);
      });
    }
  };
  for (std::size_t at = 0; at < hands.size(); ++at)
    input_log.sample(static_cast<std::uint8_t>(at), hands[at].first);
  while (!cli::stop_requested() && !gloves::have_ended(hands) &&
         (duration_s <= 0.0 || to_seconds(HostClock::now() - start) < duration_s)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    drain();
  }
  gloves::stop(hands);
  drain();
  return poses;
}

void print_wrist(const gloves::OpenHand& hand, std::uint64_t poses) {
  const driver::TrackerStation& station = hand.wrist->station;
  cli::print("  {:14} {} poses; {}\n", fmt::format("{} wrist", name_of(hand.side)), poses,
             printable(station.source));
  cli::print("  {:14} {}\n", "", driver::in_words(driver::counts_of(station.tracker->stats())));
}

nlohmann::ordered_json wrist_json(const gloves::OpenHand& hand, std::uint64_t poses) {
  const driver::TrackerStation& station = hand.wrist->station;
  nlohmann::ordered_json wrist{{"hand", name_of(hand.side)},
                               {"source", station.source},
                               {"station", station.station},
                               {"poses", poses}};
  gloves::add_counts(wrist, driver::counts_of(station.tracker->stats()));
  return wrist;
}

void print_summary(const Options& options, const std::vector<gloves::OpenHand>& hands,
                   const recording::Recorded& recorded, const PoseCounts& poses, double elapsed_s) {
  if (!options.json) {
    cli::print("recorded {} samples in {:.1f} s; {} bytes in {}\n", recorded.samples, elapsed_s,
               recorded.bytes, options.out);
    for (std::size_t at = 0; at < hands.size(); ++at)
      cli::print("  {:14} {}\n", fmt::format("{} hand", name_of(hands[at].side)),
                 driver::in_words(recorded.sent[at]));
    for (std::size_t at = 0; at < hands.size(); ++at)
      if (hands[at].wrist) print_wrist(hands[at], poses[at]);
    if (recorded.lost > 0)
      cli::print("  {:14} {} of these samples, because the disk was too slow\n", "not recorded",
                 recorded.lost);
    return;
  }
  nlohmann::ordered_json line{{"event", "recorded"},
                              {"elapsed_s", elapsed_s},
                              {"samples", recorded.samples},
                              {"lost", recorded.lost},
                              {"bytes", recorded.bytes}};
  for (std::size_t at = 0; at < hands.size(); ++at) {
    nlohmann::ordered_json glove{{"hand", name_of(hands[at].side)},
                                 {"source", hands[at].glove->info().source}};
    gloves::add_counts(glove, recorded.sent[at]);
    line["gloves"].push_back(std::move(glove));
  }
  line["wrists"] = nlohmann::ordered_json::array();
  for (std::size_t at = 0; at < hands.size(); ++at)
    if (hands[at].wrist) line["wrists"].push_back(wrist_json(hands[at], poses[at]));
  cli::print_line(line);
}

int record(Options& options) {
  if (const auto fine = check(options); !fine) return cli::report(fine.error());
  cli::install_stop_signals();
  auto hands = open_gloves(options);
  if (!hands) return cli::report(hands.error());
  flow::InputLog input_log;
  recording::RecorderOptions wanted;
  wanted.file = options.out;
  wanted.report = cli::note;
  wanted.sent = [&hands] { return session::counts_of(*hands); };
  const HostTime start = HostClock::now();
  auto recorder =
      recording::Recorder::begin(setup_for(*hands, options), input_log, std::move(wanted));
  if (!recorder) return cli::report(recorder.error());
  const PoseCounts poses = copy_samples(*hands, input_log, options.duration_s);
  const auto recorded = (*recorder)->end();
  if (!recorded) return static_cast<int>(recorded.error().code); // it was reported at once
  print_summary(options, *hands, *recorded, poses, to_seconds(HostClock::now() - start));
  return 0;
}

} // namespace
} // namespace nendo::app::record_command

void nendo::app::add_record(cli::Command& program) {
  using namespace record_command;
  cli::Command command = program.add_command("record", "Records what gloves and trackers send");
  Options& options = command.on_chosen<Options>(record);
  command.set_footer("A recording can be used as a glove, and as a tracker: replay:FILE. `nendo "
                     "run --record` records "
                     "a whole run, so that it can be replayed to the same shape.");
  command.add_option("GLOVE", options.gloves, "One, or one for each hand: serial:/dev/ttyUSB0, sim")
      .required();
  command.add_option("--out", options.out, "The recording, a new file").required();
  command.add_duration("--duration", options.duration_s,
                       "How long, e.g. 30s or 10m; 0: until Ctrl-C, or until the gloves end, "
                       "as replay:FILE does");
  gloves::add_wrist_options(command, options.wrists);
  gloves::add_calibration_options(command, options.calibration, true);
  gloves::add_hand_length(command, options.length);
  command.add_flag("--json", options.json, "A summary as one JSON object");
}
