// nendo poses: writes the poses of one or two hands as JSON lines or BVH files.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/driver/record_counts.hpp>
#include <nendo/flow/pacer.hpp>
#include <nendo/hand/angle_sources.hpp>
#include <nendo/hand/bvh_file.hpp>
#include <nendo/hand/sensor_gate.hpp>
#include <nendo/hand/wearer.hpp>

#include "cli/cli.hpp"
#include "cli/quantities.hpp"
#include "export/motion_files.hpp"
#include "gloves/glove_json.hpp"
#include "gloves/open_hand.hpp"
#include "gloves/sample_grid.hpp"
#include "gloves/stuck_sensors.hpp"
#include "nendo/commands.hpp"
#include "session/open_hands.hpp"

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
  if (auto fine = session::check_count(options.gloves); !fine) return fine;
  if (auto fine = options.length.check(); !fine) return fine;
  return gloves::check(options.calibration);
}

hand::HandSkeleton skeleton_for(Side side, const gloves::OpenHand& hand) {
  return hand::HandSkeleton(side, hand.wearer.of(side).size);
}

class PoseOutput {
public:
  PoseOutput() = default;
  PoseOutput(const PoseOutput&) = delete;
  PoseOutput& operator=(const PoseOutput&) = delete;
  virtual ~PoseOutput() = default;

  /// Returns the hand of which every pose must be, or nullopt if any hand will do.
  virtual std::optional<Side> only_side() const = 0;
  /// Takes a pose that was made of these angles, which these sensors measured, but for those that
  /// were left out. Keeps it until flush(), which it calls itself when much is kept; blocks then.
  virtual Result<void> put(HostTime time, Side side, const hand::HandPose& pose,
                           const hand::JointAngles& angles, SensorMask sensors,
                           SensorMask left_out) = 0;
  /// Writes the kept poses. Blocks as long as the disk or the reader does. Error: failed.
  virtual Result<void> flush() = 0;
  /// Flushes and completes the output. Must be the last call. Error: failed.
  virtual Result<void> finish() = 0;
};

// A rate that the machine cannot keep up with must not fill its memory.
constexpr std::size_t max_pending_bytes = 1 << 16;
constexpr std::uint64_t max_pending_frames = 64;

/// Of the estimated angles alone.
nlohmann::ordered_json deviations_json(const hand::JointAngles& angles, SensorMask sensors,
                                       SensorMask left_out) {
  const hand::AngleSources sources = hand::angle_sources(sensors, left_out);
  const hand::AngleDeviations deviations = hand::angle_deviations(angles, sensors, left_out);
  nlohmann::ordered_json by_angle;
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    if (hand::is_estimated(sources[at]))
      by_angle[std::string(hand::angle_names[at])] =
          std::round(10.0 * to_degrees(deviations[at])) / 10.0;
  return by_angle;
}

/// Returns the line of a pose without a line end, with the key angles if it is a glove's first.
std::string pose_json(HostTime time, Side side, const hand::HandPose& pose,
                      const hand::JointAngles& angles, SensorMask sensors, SensorMask left_out,
                      bool is_first) {
  nlohmann::ordered_json line{{"time_s", to_seconds(time.time_since_epoch())},
                              {"hand", name_of(side)},
                              {"joints", gloves::joints_json(pose)}};
  if (auto deviations = deviations_json(angles, sensors, left_out); !deviations.empty())
    line["deviations_deg"] = std::move(deviations);
  if (left_out.bits != 0) line["left_out"] = gloves::sensors_json(left_out);
  if (is_first) line["angles"] = gloves::angle_sources_json(sensors, left_out);
  return cli::json_text(line);
}

/// Writes a JSON object in a line for each pose to standard output. Its keys are time_s (host
/// clock), hand ("left" or "right") and joints, with what gloves::joints_json() returns. The
/// first pose of each glove has also the key angles, with what angle_sources_json() returns. A pose
/// with estimated angles has the key deviations_deg: by the name of each of these angles, one
/// standard deviation (hand::angle_deviations()). Where sensors are stuck, the key left_out has
/// their names.
class JsonLines final : public PoseOutput {
public:
  std::optional<Side> only_side() const override { return std::nullopt; }
  Result<void> put(HostTime time, Side side, const hand::HandPose& pose,
                   const hand::JointAngles& angles, SensorMask sensors,
                   SensorMask left_out) override {
    const bool first = gloves_.is_first(side, sensors, left_out);
    lines_ += pose_json(time, side, pose, angles, sensors, left_out, first);
    lines_ += '\n';
    return lines_.size() < max_pending_bytes ? Result<void>() : flush();
  }
  Result<void> flush() override {
    std::cout << lines_ << std::flush; // what cannot be written ends the program by itself
    lines_.clear();
    return {};
  }
  Result<void> finish() override { return flush(); }

private:
  std::string lines_;
  gloves::GloveChanges gloves_;
};

class BvhRecording final : public PoseOutput {
public:
  BvhRecording(hand::BvhFile file, std::string path, Side side)
      : file_(std::move(file)), path_(std::move(path)), side_(side) {}

  std::optional<Side> only_side() const override { return side_; }
  Result<void> put(HostTime, Side, const hand::HandPose& pose, const hand::JointAngles&, SensorMask,
                   SensorMask) override {
    if (auto added = file_.add(pose); !added) return added;
    return ++put_ % max_pending_frames != 0 ? Result<void>() : flush();
  }
  Result<void> flush() override { return file_.flush(); }
  Result<void> finish() override {
    if (auto finished = file_.finish(); !finished) return finished;
    std::cout << path_ << ": " << file_.frames() << " poses of a " << name_of(side_) << " hand"
              << std::endl;
    return {};
  }

private:
  hand::BvhFile file_;
  std::string path_;
  Side side_;
  std::uint64_t put_ = 0;
};

/// Makes poses of samples and puts them into an output, until there are enough.
class PoseStream {
public:
  /// `written` counts the poses of all gloves.
  PoseStream(gloves::OpenHand& hand, const Options& options, PoseOutput& output,
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
  PoseOutput& output() const noexcept { return output_; }

private:
  bool take(const GloveSample& sample) {
    const GloveSample passed = gate_.pass(sample, calibration_.follow(sample));
    for (const std::string& sentence : stuck_.changes(calibration_.left_out(sample), &sample))
      cli::note(hand_.glove->info().source + ": " + sentence);
    return grid_.take(passed, std::bind_front(&PoseStream::put, this));
  }
  bool pass_time(HostTime now) {
    return grid_.pass_time(now, std::bind_front(&PoseStream::put, this)) && !is_over(now);
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
  PoseOutput& output_;
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

using Outputs = std::vector<std::unique_ptr<PoseOutput>>;

/// One for all gloves, or one for each.
Result<Outputs> open_outputs(const Options& options, const std::vector<gloves::OpenHand>& hands) {
  Outputs outputs;
  if (options.bvh.empty()) outputs.push_back(std::make_unique<JsonLines>());
  for (const gloves::OpenHand& hand : hands) {
    if (options.bvh.empty()) break;
    const std::string name =
        hands.size() == 1 ? options.bvh : exporting::path_of_hand(options.bvh, hand.side).string();
    auto file = hand::BvhFile::create(name, skeleton_for(hand.side, hand), rate_of(options));
    if (!file) return file.error();
    outputs.push_back(std::make_unique<BvhRecording>(*std::move(file), name, hand.side));
  }
  return outputs;
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
  auto hands = session::open_each(options.gloves);
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
} // namespace nendo::app::poses_command

void nendo::app::add_poses(cli::Command& program) {
  using namespace poses_command;
  cli::Command command = program.add_command(
      "poses", "Writes hands' poses: OpenXR's 26 joints as JSON lines, or a BVH file");
  Options& options = command.on_chosen<Options>(poses);
  command.set_footer(
      "A glove measures no position: the forearm ends at the origin, -Z points to the fingertips, "
      "+Y\nout of the back of the hand. JSON is in metres, with quaternions x, y, z, w; BVH in "
      "centimetres\nand degrees, and named FILE.part until it is complete. time_s is the time of "
      "the "
      "sample or,\nwith --rate, of the pose.");
  command.add_option("GLOVE", options.gloves, "One or two: serial:/dev/ttyUSB0, sim, auto, ...")
      .required();
  command.add_option("--bvh", options.bvh,
                     "Write this file instead of JSON lines; with two gloves, FILE-left.bvh and "
                     "FILE-right.bvh");
  command.add_rate("--rate", options.rate_hz,
                   "Poses per second, 1 to 10000, each of the newest sample; without it, one per "
                   "sample, and 90 per second in a BVH file");
  command.add_duration("--duration", options.duration_s,
                       "How long, e.g. 30s or 10m; 0: until Ctrl-C, or until a "
                       "recording (replay:FILE) ends");
  command.add_option("--count", options.count,
                     "End after this number of poses, both gloves together");
  gloves::add_hand_length(command, options.length);
  gloves::add_calibration_options(command, options.calibration, true);
}
