// nendo poses: writes the poses of one or two hands as JSON lines or BVH files.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <nendo/driver/record_counts.hpp>
#include <nendo/flow/tick_grid.hpp>
#include <nendo/hand/active_calibration.hpp>
#include <nendo/hand/sensor_gate.hpp>

#include "cli/cli.hpp"
#include "cli/quantities.hpp"
#include "export/hands_bvh.hpp"
#include "gloves/open_hand.hpp"
#include "gloves/pose_output.hpp"
#include "gloves/sample_grid.hpp"
#include "gloves/stuck_sensors.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::poses_command {
namespace {

constexpr double default_bvh_rate_hz = 90.0;

struct Options {
  std::vector<std::string> gloves;
  std::string bvh;
  double rate_hz = 0.0;
  double duration_s = 0.0;
  std::uint64_t count = 0;
  gloves::HandLength length;
  gloves::CalibrationOptions calibration;
};

/// Returns the rate as the grid rounds it, so that a file states the rate that it has.
double rate_of(const Options& options) {
  const double rate_hz =
      options.rate_hz == 0.0 && !options.bvh.empty() ? default_bvh_rate_hz : options.rate_hz;
  return std::round(rate_hz * 1000.0) / 1000.0;
}

Result<void> check(const Options& options) {
  const double rate_hz = options.rate_hz;
  if (rate_hz != 0.0 &&
      !(rate_hz >= flow::TickGrid::min_rate_hz && rate_hz <= flow::TickGrid::max_rate_hz)) {
    return Error{Errc::usage, "--rate: use 1 to 10000 poses per second, or leave it out"};
  }
  if (auto fine = cli::check_duration(options.duration_s); !fine) return fine.error();
  if (options.gloves.size() > 2)
    return Error{Errc::usage,
                 "GLOVE: takes 1 or 2 gloves, got " + std::to_string(options.gloves.size())};
  if (auto fine = options.length.check(); !fine) return fine;
  return gloves::check(options.calibration);
}

hand::HandSkeleton skeleton_for(Side side, const gloves::OpenHand& hand) {
  return hand::HandSkeleton(side, hand.wearer.of(side).size);
}

/// Makes poses of samples and puts them into an output, until there are enough.
class PoseStream {
public:
  /// `written` counts the poses of all gloves.
  PoseStream(gloves::OpenHand& hand, const Options& options, gloves::PoseOutput& output,
             std::uint64_t& written)
      : hand_(hand), options_(options), output_(output), written_(written),
        start_(hand.first.arrival), calibration_(hand.wearer),
        left_(skeleton_for(Side::left, hand)), right_(skeleton_for(Side::right, hand)),
        grid_(start_, rate_of(options)) {}

  /// Takes what has come, and then the time. Returns false if no more will come or is wanted, or if
  /// the output has failed.
  bool advance() {
    const bool ended = hand_.glove->has_ended(); // then all that it sent is in the ring
    const HostTime now = HostClock::now();       // what came before it is in the ring
    bool continues = is_first_taken_ || take(hand_.first);
    is_first_taken_ = true;
    for (GloveSample sample; continues && hand_.ring->try_pop(sample);)
      continues = take(sample);
    return continues && pass_time(now) && !ended;
  }
  const Result<void>& state() const noexcept { return state_; }
  gloves::PoseOutput& output() const noexcept { return output_; }

private:
  bool take(const GloveSample& sample) {
    const GloveSample passed = gate_.pass(sample, calibration_.follow(sample));
    for (const std::string& sentence : stuck_.changes(calibration_.left_out(sample), &sample))
      cli::note(hand_.glove->info().source + ": " + sentence);
    return grid_.take(
        passed, [this](HostTime time, const GloveSample& newest) { return put(time, newest); });
  }
  bool pass_time(HostTime now) {
    const bool continues = grid_.pass_time(
        now, [this](HostTime time, const GloveSample& newest) { return put(time, newest); });
    return continues && !is_over(now);
  }
  bool is_over(HostTime time) const {
    return options_.duration_s > 0.0 && time - start_ >= from_seconds(options_.duration_s);
  }
  bool put(HostTime time, const GloveSample& sample) {
    if (is_over(time) || is_enough() || cli::stop_requested()) return false;
    const Side side = output_.only_side().value_or(sample.side);
    const auto& skeleton = side == Side::left ? left_ : right_;
    const SensorMask left_out = calibration_.left_out(sample);
    const auto angles = hand::joint_angles(sample, calibration_.of(sample.side), left_out);
    // A glove does not know where it is: the forearm ends at the origin.
    state_ = output_.put(time, side, skeleton.pose(angles, Eigen::Isometry3d::Identity()), angles,
                         sample.present, left_out);
    ++written_;
    return state_ && !is_enough();
  }
  bool is_enough() const { return options_.count != 0 && written_ >= options_.count; }

  gloves::OpenHand& hand_;
  const Options& options_;
  gloves::PoseOutput& output_;
  std::uint64_t& written_;
  bool is_first_taken_ = false;
  HostTime start_;
  hand::ActiveCalibration calibration_;
  hand::SensorGate gate_;
  gloves::StuckNotices stuck_;
  hand::HandSkeleton left_;
  hand::HandSkeleton right_;
  gloves::SampleGrid grid_;
  Result<void> state_;
};

Result<void> stream(std::span<PoseStream> streams) {
  std::vector<bool> active(streams.size(), true);
  const auto any = [&] { return std::find(active.begin(), active.end(), true) != active.end(); };
  while (any() && !cli::stop_requested()) {
    for (std::size_t at = 0; at < streams.size(); ++at) {
      if (!active[at]) continue;
      active[at] = streams[at].advance();
      if (!streams[at].state()) return streams[at].state();
      if (auto flushed = streams[at].output().flush(); !flushed) return flushed;
    }
    if (any()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return {};
}

using Outputs = std::vector<std::unique_ptr<gloves::PoseOutput>>;

/// One for all gloves, or one for each.
Result<Outputs> open_outputs(const Options& options, const std::vector<gloves::OpenHand>& hands) {
  Outputs outputs;
  if (options.bvh.empty()) outputs.push_back(gloves::json_pose_output());
  for (const gloves::OpenHand& hand : hands) {
    if (options.bvh.empty()) break;
    const std::string name =
        hands.size() == 1 ? options.bvh : exporting::path_of_hand(options.bvh, hand.side).string();
    auto file = gloves::bvh_pose_output(name, skeleton_for(hand.side, hand), rate_of(options));
    if (!file) return file.error();
    outputs.push_back(*std::move(file));
  }
  return outputs;
}

Result<std::vector<gloves::OpenHand>> open_gloves(const Options& options) {
  std::vector<gloves::OpenHand> hands;
  for (const std::string& spec : options.gloves) {
    auto hand = gloves::open_hand(spec);
    if (!hand) return hand.error();
    hands.push_back(*std::move(hand));
  }
  if (hands.size() == 2 && hands[0].side == hands[1].side)
    return gloves::same_hand(hands[0], hands[1]);
  return hands;
}

void note_losses(const gloves::OpenHand& hand) {
  const auto counts = driver::counts_of(hand.glove->stats());
  if (counts.refused > 0)
    cli::note(std::to_string(counts.refused) +
              " samples were refused, because the poses were not read fast enough");
  if (counts.missed > 0) cli::note(hand.glove->info().source + ": " + driver::in_words(counts));
}

Result<void> poses(const Options& options) {
  if (auto fine = check(options); !fine) return fine;
  auto hands = open_gloves(options);
  if (!hands) return hands.error();
  cli::install_stop_signals();
  if (auto started = gloves::start(*hands); !started) return started;
  if (auto done = gloves::calibrate(*hands, options.calibration, options.length); !done)
    return done;
  const auto outputs = open_outputs(options, *hands); // a BVH file begins with the wearer's bones
  if (!outputs) return outputs.error();

  std::uint64_t written = 0;
  std::vector<PoseStream> streams;
  for (std::size_t at = 0; at < hands->size(); ++at)
    streams.emplace_back((*hands)[at], options, *(*outputs)[std::min(at, outputs->size() - 1)],
                         written);
  const auto streamed = stream(streams);
  for (const gloves::OpenHand& hand : *hands) {
    hand.glove->stop();
    note_losses(hand);
  }
  if (!streamed) return streamed.error();
  for (const auto& output : *outputs)
    if (const auto finished = output->finish(); !finished) return finished.error();
  return {};
}

} // namespace

void add(cli::Command& program) {
  auto options = std::make_shared<Options>();
  cli::Command command = program.add_command(
      "poses", "Writes hands' poses: OpenXR's 26 joints as JSON lines, or a BVH file");
  command.set_footer(
      "A glove measures no position: the forearm ends at the origin, -Z points to the fingertips, "
      "+Y\nout of the back of the hand. JSON is in metres, with quaternions x, y, z, w; BVH in "
      "centimetres\nand degrees, and named FILE.part until it is complete. time_s is the time of "
      "the "
      "sample or,\nwith --rate, of the pose.");
  command.add_option("GLOVE", options->gloves, "One or two: serial:/dev/ttyUSB0, sim, auto, ...")
      .required();
  command.add_option("--bvh", options->bvh,
                     "Write this file instead of JSON lines; with two gloves, FILE-left.bvh and "
                     "FILE-right.bvh");
  command.add_rate("--rate", options->rate_hz,
                   "Poses per second, 1 to 10000, each of the newest sample; without it, one per "
                   "sample, and 90 per second in a BVH file");
  command.add_duration("--duration", options->duration_s,
                       "How long, e.g. 30s or 10m; 0: until Ctrl-C, or until a "
                       "recording (replay:FILE) ends");
  command.add_option("--count", options->count,
                     "End after this number of poses, both gloves together");
  gloves::add_hand_length(command, options->length);
  gloves::add_calibration_options(command, options->calibration, true);
  command.on_chosen([options] { return poses(*options); });
}

} // namespace nendo::app::poses_command
