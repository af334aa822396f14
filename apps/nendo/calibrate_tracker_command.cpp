// nendo calibrate tracker: finds how a tracker's station is fastened to an arm, and how late it is.

#include <array>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <nendo/base/text.hpp>
#include <nendo/driver/open_tracker.hpp>
#include <nendo/hand/tracker_calibration.hpp>
#include <nendo/hand/tracker_mount.hpp>
#include <nendo/recording/replay_driver.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "calibrate/tracker_exercise.hpp"
#include "cli/cli.hpp"
#include "gloves/open_hand.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::calibrate_tracker_command {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string tracker;
  std::string glove;
  std::string side;
  std::string mounted;
  std::string user;
  std::string out;
  double duration_s = 10.0;
};

Result<void> check(const Options& options) {
  if (!(options.duration_s >= 5.0 && options.duration_s <= 60.0))
    return Error{Errc::usage, "--duration: use 5s to 60s"};
  if (options.glove.empty() && options.side.empty())
    return Error{Errc::usage,
                 "--side is missing: without a glove, say which hand it is, e.g. --side right"};
  if (options.glove.empty() && !options.user.empty())
    return Error{Errc::usage, "--user is the wearer of a glove: name it with --glove, or leave "
                              "--user out"};
  return {};
}

Result<driver::TrackerStation> open_station(const std::string& spec) {
  cli::install_stop_signals();
  const std::array more{recording::replay_tracker_driver()};
  auto stations = driver::open_trackers({&spec, 1}, more);
  if (cli::stop_requested())
    return Error{Errc::failed, spec + ": interrupted while its tracker was being identified"};
  if (!stations) return stations.error();
  return stations->front();
}

/// The glove beside the tracker; none without --glove.
struct Gloved {
  std::unique_ptr<driver::Glove> glove;
  hand::Wearer wearer;
  Side side = Side::right;
};

Result<Gloved> open_gloved(const Options& options) {
  Gloved gloved;
  const auto side = side_named(options.side);
  gloved.side = side.value_or(Side::right);
  if (options.glove.empty()) return gloved;
  auto glove = gloves::open_glove(options.glove, side);
  if (!glove) return glove.error();
  gloved.glove = *std::move(glove);
  if (!side) gloved.side = gloved.glove->info().side;
  gloves::CalibrationOptions calibration;
  calibration.user = options.user;
  const auto wearer =
      sculpting::find_wearer(gloved.glove->info(), gloved.side, calibration, cli::note);
  if (!wearer) return wearer.error();
  gloved.wearer = *wearer;
  return gloved;
}

/// A glove that does not measure its wrist has no forearm of its own, so its station is usually on
/// the hand.
bool is_on_hand(const Options& options, const Gloved& gloved) {
  if (!options.mounted.empty()) return options.mounted == "hand";
  return gloved.glove != nullptr && !calibrate::measures_wrist(*gloved.glove);
}

Result<fs::path> path_of(const Options& options, const driver::TrackerStation& station, Side side) {
  if (!options.out.empty()) return fs::path(options.out);
  return hand::own_mount_path(station.mount_source(), station.mount_station(), side);
}

Result<void> write_result(const Options& options, const driver::TrackerStation& station, Side side,
                          const hand::TrackerCalibration& made) {
  hand::TrackerMount file;
  file.tracker = hand::tracker_name(station.mount_source());
  file.station = station.mount_station();
  file.side = side;
  hand::set_mount(file, made.mount);
  file.residual_mm = made.report.residual_mm;
  file.taken = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const auto path = path_of(options, station, side);
  if (!path) return path.error();
  if (auto written = hand::write_mount(*path, file); !written) return written;
  std::cout << "wrote " << printable(path->string()) << '\n';
  return {};
}

Result<void> calibrate_station(const Options& options) {
  if (auto fine = check(options); !fine) return fine;
  const auto station = open_station(options.tracker);
  if (!station) return station.error();
  const auto gloved = open_gloved(options);
  if (!gloved) return gloved.error();
  const driver::TrackerInfo& info = station->tracker->info();

  hand::TrackerExercise exercise;
  exercise.side = gloved->side;
  exercise.stage_from_tracker =
      Eigen::Quaterniond(info.stage_from_tracker_xyzw.data()).normalized();
  exercise.on_hand = is_on_hand(options, *gloved);
  cli::note(std::string(exercise.on_hand ? hand::hand_exercise : hand::forearm_exercise) + " (" +
            std::string(name_of(exercise.side)) + " hand, station " +
            std::to_string(station->station) + " on the " +
            (exercise.on_hand ? "hand" : "forearm") + ")");
  calibrate::ExerciseOptions recording;
  recording.duration_s = options.duration_s;
  const auto recorded = calibrate::record_exercise(*station, gloved->glove.get(), gloved->wearer,
                                                   recording, cli::note);
  if (!recorded) return recorded.error();
  exercise.poses = recorded->poses;
  exercise.wrist = recorded->wrist;
  const auto made = hand::calibrate_tracker(exercise);
  if (!made)
    return Error{made.error().code, printable(station->source) + ": " + made.error().message};
  for (const std::string& line : calibrate::exercise_report(*made))
    std::cout << line << '\n';
  return write_result(options, *station, exercise.side, *made);
}

} // namespace
} // namespace nendo::app::calibrate_tracker_command

void nendo::app::add_calibrate_tracker(cli::Command& calibrate) {
  using namespace calibrate_tracker_command;
  cli::Command command = calibrate.add_command(
      "tracker", "Finds where a tracker's station sits on the arm, and how late the tracker is");
  Options& options = command.on_chosen<Options>(calibrate_station);
  command
      .add_option("--tracker", options.tracker,
                  "TRACKER and its station, as for --right-wrist of nendo run")
      .required();
  command.add_option("--glove", options.glove,
                     "GLOVE on the same hand, which measures its wrist; without it the time offset "
                     "stays unknown");
  command.add_option("--side", options.side, "The hand; without it, the glove's")
      .one_of({"left", "right"});
  command
      .add_option("--mounted", options.mounted,
                  "Where the station is; without it, on the forearm, or on the hand if the glove "
                  "does not measure its wrist")
      .one_of({"forearm", "hand"});
  command.add_option("--user", options.user, "Wearer of the glove, whose calibration is used");
  command.add_duration("--duration", options.duration_s, "Length of the exercise, 5s to 60s");
  command.add_option("--out", options.out,
                     "Where to write the mount; without it, where other commands find it");
  command.set_footer("The exercise: " + std::string(hand::forearm_exercise) +
                     " Circles of changing size and speed are best. For a station on the back of "
                     "the hand: " +
                     std::string(hand::hand_exercise) +
                     " A bad exercise is refused, and nothing is written.");
}
