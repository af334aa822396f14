// nendo poses: the poses of a glove's hand, as JSON lines or as a BVH file.

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <thread>

#include <nendo/driver/record_counts.hpp>
#include <nendo/flow/tick_grid.hpp>
#include <nendo/hand/active_calibration.hpp>
#include <nendo/hand/sensor_gate.hpp>

#include "cli/cli.hpp"
#include "gloves/open_hand.hpp"
#include "gloves/pose_output.hpp"
#include "gloves/sample_grid.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::poses_command {
namespace {

constexpr double default_bvh_rate_hz = 90.0;
constexpr double most_duration_s = 1e7;

struct Options {
  std::string glove;
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
      !(rate_hz >= flow::TickGrid::least_rate_hz && rate_hz <= flow::TickGrid::most_rate_hz)) {
    return Error{Errc::usage, "--rate: use 1 to 10000 poses a second, or leave it out"};
  }
  if (!(options.duration_s >= 0.0 && options.duration_s <= most_duration_s)) {
    return Error{Errc::usage, "--duration: use a number of seconds up to 10000000, 0 for no end"};
  }
  if (auto fine = options.length.check(); !fine) return fine;
  return gloves::check(options.calibration);
}

hand::HandSkeleton skeleton_for(Side side, const gloves::OpenHand& hand) {
  return hand::HandSkeleton(side, hand.wearer.of(side).size);
}

/// Makes poses of samples and puts them into an output, until there are enough.
class PoseStream {
public:
  PoseStream(const gloves::OpenHand& hand, const Options& options, gloves::PoseOutput& output)
      : options_(options), output_(output), start_(hand.first.arrival), calibration_(hand.wearer),
        left_(skeleton_for(Side::left, hand)), right_(skeleton_for(Side::right, hand)),
        grid_(start_, rate_of(options)) {}

  /// Returns false if no more is wanted or the output has failed.
  bool take(const GloveSample& sample) {
    const GloveSample passed = gate_.pass(sample, calibration_.follow(sample));
    return grid_.take(
        passed, [this](HostTime time, const GloveSample& newest) { return put(time, newest); });
  }
  /// Returns false if no more is wanted or the output has failed.
  bool pass_time(HostTime now) {
    const bool goes_on = grid_.pass_time(
        now, [this](HostTime time, const GloveSample& newest) { return put(time, newest); });
    return goes_on && !is_over(now);
  }
  const Result<void>& state() const noexcept { return state_; }

private:
  bool is_over(HostTime time) const {
    return options_.duration_s > 0.0 && time - start_ >= from_seconds(options_.duration_s);
  }
  bool put(HostTime time, const GloveSample& sample) {
    if (is_over(time) || cli::stop_requested()) return false;
    const Side side = output_.only_side().value_or(sample.side);
    const auto& skeleton = side == Side::left ? left_ : right_;
    const auto angles = hand::joint_angles(sample, calibration_.of(sample.side));
    // A glove does not know where it is: the forearm ends at the origin.
    state_ = output_.put(time, side, skeleton.pose(angles, Eigen::Isometry3d::Identity()), angles,
                         sample.present);
    return state_ && ++written_ != options_.count;
  }

  const Options& options_;
  gloves::PoseOutput& output_;
  HostTime start_;
  hand::ActiveCalibration calibration_;
  hand::SensorGate gate_;
  hand::HandSkeleton left_;
  hand::HandSkeleton right_;
  gloves::SampleGrid grid_;
  std::uint64_t written_ = 0;
  Result<void> state_;
};

Result<void> stream(gloves::OpenHand& hand, const Options& options, gloves::PoseOutput& output) {
  PoseStream poses(hand, options, output);
  GloveSample sample;
  bool goes_on = poses.take(hand.first);
  while (goes_on && !cli::stop_requested()) {
    const bool ended = hand.glove->has_ended(); // then all that it sent is in the ring
    const HostTime now = HostClock::now();      // what came before it is in the ring
    while (goes_on && hand.ring->try_pop(sample))
      goes_on = poses.take(sample);
    goes_on = goes_on && poses.pass_time(now);
    if (auto flushed = output.flush(); !flushed) return flushed;
    goes_on = goes_on && !ended;
    if (goes_on) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return poses.state();
}

Result<std::unique_ptr<gloves::PoseOutput>> open_output(const Options& options,
                                                        const gloves::OpenHand& hand) {
  if (options.bvh.empty()) return gloves::json_pose_output();
  return gloves::bvh_pose_output(options.bvh, skeleton_for(hand.side, hand), rate_of(options));
}

int poses(const Options& options) {
  if (const auto fine = check(options); !fine) return cli::report(fine.error());
  auto hand = gloves::open_hand(options.glove);
  if (!hand) return cli::report(hand.error());
  cli::install_stop_signals();
  const std::span hands(&*hand, 1);
  if (const auto started = gloves::start(hands); !started) return cli::report(started.error());
  if (const auto done = gloves::calibrate(hands, options.calibration, options.length); !done)
    return cli::report(done.error());
  const auto output = open_output(options, *hand); // a BVH file begins with the wearer's bones
  if (!output) return cli::report(output.error());

  const auto streamed = stream(*hand, options, **output);
  hand->glove->stop();
  const auto counts = driver::counts_of(hand->glove->stats());
  if (counts.refused > 0)
    cli::note(std::to_string(counts.refused) +
              " samples were refused: the poses were not taken fast enough");
  if (counts.missed > 0) cli::note(hand->glove->info().source + ": " + driver::in_words(counts));
  if (!streamed) return cli::report(streamed.error());
  const auto finished = (*output)->finish();
  return finished ? 0 : cli::report(finished.error());
}

} // namespace

void add(cli::Command& program) {
  auto options = std::make_shared<Options>();
  cli::Command command = program.add_command(
      "poses", "Writes a hand's poses: OpenXR's 26 joints as JSON lines, or a BVH file");
  command.set_footer(
      "A glove measures no position: the forearm ends at the origin, -Z goes to the fingertips, "
      "+Y\nout of the back of the hand. JSON is in metres, with quaternions x, y, z, w; BVH in "
      "centimetres\nand degrees, FILE.part until it is complete. time_s is when the sample came, "
      "with --rate "
      "when\nthe pose was due.");
  command.add_option("GLOVE", options->glove, "serial:/dev/ttyUSB0, sim, auto, ...").required();
  command.add_option("--bvh", options->bvh, "Write this file instead of JSON lines");
  command.add_option("--rate", options->rate_hz,
                     "Poses a second, 1 to 10000, each of the newest sample; without it, one a "
                     "sample, in a BVH file 90 a second");
  command.add_duration("--duration", options->duration_s,
                       "How long, e.g. 30s or 10m; 0: until Ctrl-C, or until a "
                       "recording (replay:FILE) ends");
  command.add_option("--count", options->count, "End after so many poses");
  gloves::add_hand_length(command, options->length);
  gloves::add_calibration_options(command, options->calibration);
  command.on_chosen([options] { return poses(*options); });
}

} // namespace nendo::app::poses_command
