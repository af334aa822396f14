// nendo calibrate: makes a calibration from a wearer's poses.

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <unistd.h>

#include <nendo/base/text.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/hand/calibration_file.hpp>
#include <nendo/hand/calibration_store.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "calibrate/capture_file.hpp"
#include "calibrate/report.hpp"
#include "calibrate/session.hpp"
#include "cli/cli.hpp"
#include "gloves/open_hand.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"

namespace nendo::app::calibrate_command {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string glove;
  std::string user;
  std::string from;
  std::string out;
  std::string picture;
  double length_mm = 1e3 * hand::HandSize{}.length_m;
  double breadth_mm = 1e3 * hand::HandSize{}.breadth_m;
  std::string stiff;
  SensorMask stiff_sensors{}; ///< what `stiff` says
  bool quick = false;
  bool touch_up = false;
  bool fresh = false;
};

/// The wearer whose calibration is made.
struct Wearer {
  hand::WearerCalibration about; ///< everything but the calibration itself, at first
  SensorMask sensors;
  fs::path path;                                ///< path of its file
  std::optional<hand::WearerCalibration> known; ///< what is touched up
};

/// Returns the sensors of the fingers in a list, and of the wrist.
Result<SensorMask> sensors_of(const std::string& list) {
  SensorMask mask;
  for (std::string_view rest = list; !rest.empty();) {
    const std::string_view name = cut(rest, ',');
    SensorMask found = name == "wrist" ? mask_of(std::array{Sensor::wrist_pitch, Sensor::wrist_yaw})
                                       : SensorMask{};
    for (std::size_t at = 0; at < hand::finger_count; ++at)
      if (name == hand::name_of(static_cast<hand::Finger>(at)))
        found = hand::sensors_of(static_cast<hand::Finger>(at));
    if (found.bits == 0)
      return Error{Errc::usage, "--stiff " + printable(list) +
                                    ": use thumb, index, middle, ring, little and wrist, with "
                                    "commas between"};
    mask.bits |= found.bits;
  }
  return mask;
}

Result<void> check(const Options& options) {
  if (options.quick && options.touch_up)
    return Error{Errc::usage, "--quick and --touch-up cannot be combined; give one of them"};
  if (options.glove.empty() == options.from.empty())
    return Error{Errc::usage, "name a GLOVE, or a capture with --from FILE"};
  if (options.user.empty())
    return Error{Errc::usage, "--user is missing: name the wearer, e.g. --user anna"};
  if (auto fine = gloves::HandLength{options.length_mm}.check(); !fine) return fine;
  if (!(options.breadth_mm >= 50.0 && options.breadth_mm <= 130.0))
    return Error{Errc::usage, "--hand-breadth: use 50 to 130 millimetres, across the knuckles"};
  const bool at_terminal = ::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0;
  if (options.from.empty() && !at_terminal)
    return Error{Errc::usage, "the guided calibration needs a terminal; elsewhere use --from FILE"};
  return {};
}

hand::HandSize size_of(const Options& options) {
  return {1e-3 * options.length_mm, 1e-3 * options.breadth_mm};
}

/// `known` is what a touch-up begins with.
hand::FitOptions fit_options(const Options& options, CountScale counts,
                             const std::optional<hand::WearerCalibration>& known) {
  hand::FitOptions fitting;
  fitting.stiff = options.stiff_sensors;
  fitting.scale = counts;
  if (known) {
    fitting.mode = hand::FitMode::touch_up;
    fitting.size = known->size;
    fitting.start = hand::calibration_for(*known, counts);
    fitting.start_ends = hand::reached_ends(*known);
    return fitting;
  }
  fitting.mode = options.quick ? hand::FitMode::quick : hand::FitMode::full;
  fitting.size = size_of(options);
  const hand::HandSize average;
  fitting.size_known =
      fitting.size.length_m != average.length_m || fitting.size.breadth_m != average.breadth_m;
  return fitting;
}

std::span<const hand::PoseId> poses_for(const Options& options) {
  if (options.touch_up) return hand::touch_up_poses();
  return options.quick ? hand::quick_poses() : hand::full_takes();
}

Wearer describe(const Options& options, Side side, CountScale counts, SensorMask sensors) {
  Wearer wearer;
  wearer.about.user = options.user;
  wearer.about.side = side;
  wearer.about.counts = counts;
  wearer.about.size = size_of(options);
  wearer.about.method = options.quick ? "quick" : "full";
  wearer.about.made = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  wearer.sensors = sensors;
  return wearer;
}

/// For a touch-up, takes over the calibration that there is.
Result<void> begin_with_known(Wearer& wearer, const fs::path& stored) {
  std::error_code error;
  if (!fs::exists(stored, error))
    return Error{Errc::bad_input, printable(stored.string()) +
                                      ": no calibration to touch up; calibrate without --touch-up"};
  auto known = hand::read_calibration(stored);
  if (!known) return known.error();
  if (known->counts != wearer.about.counts)
    return Error{Errc::bad_input,
                 printable(stored.string()) +
                     ": is for another kind of glove; calibrate without --touch-up"};
  const auto made = wearer.about.made;
  wearer.known = *known;
  known->made = made;
  constexpr std::string_view mark = ", touched up";
  if (!known->method.ends_with(mark)) known->method += mark;
  wearer.about = *std::move(known);
  return {};
}

/// Sets where the calibration goes, and for a touch-up takes over the one that there is.
Result<void> find_files(Wearer& wearer, const Options& options) {
  wearer.path = options.out;
  if (!options.out.empty() && !options.touch_up) return {};
  const auto stored =
      hand::own_calibration_path(options.user, wearer.about.glove_serial, wearer.about.side);
  if (!stored) return stored.error();
  if (options.out.empty()) wearer.path = *stored;
  return options.touch_up ? begin_with_known(wearer, *stored) : Result<void>();
}

/// Returns the path of the file, beside the calibration, with the poses of a session that was quit.
fs::path unfinished_path(const Wearer& wearer) {
  return wearer.path.string() + (wearer.known ? ".touch-up.unfinished" : ".unfinished");
}

/// How well a sensor's line is known, and how far the wearer went, in poses or in free motion. A
/// touch-up changes only where that lies.
void note_quality(Wearer& wearer, const hand::CalibrationFit& fit,
                  const hand::CountRanges& free_motion, std::size_t slot) {
  auto& quality = wearer.about.quality[slot];
  const hand::SensorFit& sensor = fit.sensors[slot];
  if (wearer.known) {
    const double slipped = fit.calibration.sensors[slot].offset_counts -
                           wearer.known->calibration.sensors[slot].offset_counts;
    if (quality) hand::move_ends(*quality, slipped, wearer.about.counts);
    return;
  }
  const bool known = sensor.gain_determined && sensor.offset_determined;
  quality = hand::SensorQuality{sensor.residual_rad, sensor.low_counts, sensor.high_counts,
                                known ? 1.0 : 0.0};
  if (!free_motion.present.has(static_cast<Sensor>(slot))) return;
  quality->min_counts = std::min(quality->min_counts, free_motion.low_counts[slot]);
  quality->max_counts = std::max(quality->max_counts, free_motion.high_counts[slot]);
}

void note_left_out(const std::string& source, SensorMask left_out) {
  if (left_out.bits == 0) return;
  const bool one = sculpting::is_one(left_out);
  cli::note(printable(source) + ": " + sculpting::sensors_in_words(left_out) +
            (one ? " is" : " are") + " stuck, so the calibration is made without " +
            (one ? "it" : "them") + ", and the joint is estimated from neighbouring sensors");
}

int fit_and_write(const Options& options, Wearer& wearer,
                  const calibrate::CalibrationGuide& guide) {
  const auto readings = guide.readings();
  wearer.sensors.bits &= ~guide.left_out().bits;
  wearer.about.left_out = guide.left_out();
  hand::FitOptions fitting = fit_options(options, wearer.about.counts, wearer.known);
  fitting.free_motion = guide.free_motion();
  const auto fit = hand::fit_calibration(readings, wearer.about.side, wearer.sensors, fitting);
  if (!fit) return cli::report(fit.error());
  calibrate::print_report(std::cout, *fit, readings, wearer.sensors, guide.left_out());
  wearer.about.calibration = fit->calibration;
  wearer.about.size = fit->size;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (wearer.sensors.has(static_cast<Sensor>(slot))) {
      note_quality(wearer, *fit, fitting.free_motion, slot);
    } else { // a touch-up may begin with a line of it
      wearer.about.calibration.sensors[slot] = {};
      wearer.about.quality[slot].reset();
    }
  }
  const auto earlier = hand::write_calibration(wearer.path, wearer.about);
  if (!earlier) return cli::report(earlier.error());
  std::error_code ignored;
  fs::remove(unfinished_path(wearer), ignored);
  std::cout << "wrote " << printable(wearer.path.string()) << '\n';
  if (!earlier->empty())
    std::cout << "the previous one is kept as " << printable(earlier->string()) << '\n';
  if (options.picture.empty()) return 0;
  const auto drawn =
      calibrate::write_report_picture(options.picture, *fit, wearer.about, wearer.sensors);
  if (!drawn) return cli::report(drawn.error());
  report_written(options.picture);
  return 0;
}

/// Returns the sensors that are found stuck anywhere in a capture.
SensorMask stuck_in(const calibrate::CaptureFile& capture, const Options& options,
                    SensorMask before) {
  calibrate::CalibrationGuide guide(poses_for(options), capture.counts, options.stiff_sensors);
  guide.restore(capture.readings, capture.free_motion);
  guide.leave_out(before);
  for (const GloveSample& sample : capture.samples) {
    if (!guide.has_any()) guide.push_free_motion(sample);
    const bool first = !guide.has_any();
    if (guide.push(sample) == calibrate::CalibrationGuide::Event::captured && first)
      guide.end_free_motion();
  }
  return guide.left_out();
}

int calibrate_from_capture(const Options& options) {
  const auto capture = calibrate::read_capture(options.from);
  if (!capture) return cli::report(capture.error());
  calibrate::CalibrationGuide guide(poses_for(options), capture->counts, options.stiff_sensors);
  guide.restore(capture->readings, capture->free_motion);
  guide.leave_out(calibrate::still_in(capture->readings, capture->counts));
  // A sensor may be found late. It is left out from the beginning.
  guide.leave_out(stuck_in(*capture, options, guide.left_out()));
  note_left_out(options.from, guide.left_out());
  SensorMask sensors;
  for (const auto& reading : capture->readings)
    sensors.bits |= reading.held.present.bits;
  bool noted = false; // a pose that was missed shifts all later ones, so one note is enough
  for (const GloveSample& sample : capture->samples) {
    sensors.bits |= sample.present.bits;
    if (!guide.has_any()) guide.push_free_motion(sample);
    if (guide.push(sample) == calibrate::CalibrationGuide::Event::implausible &&
        !std::exchange(noted, true))
      cli::note(options.from + ": a held pose is not " +
                std::string(hand::pose_of(guide.asked()).name) + ", because of " +
                std::string(name_of(*guide.implausible_sensor())) + "; such poses are left out");
  }
  if (!guide.is_done())
    cli::note(options.from + ": ends before the pose " +
              std::string(hand::pose_of(guide.asked()).name) + " was held" +
              (guide.is_again() ? " again" : ""));
  Wearer wearer = describe(options, capture->side, capture->counts, sensors);
  if (const auto fine = find_files(wearer, options); !fine) return cli::report(fine.error());
  if (wearer.known) guide.leave_out(wearer.known->left_out);
  return fit_and_write(options, wearer, guide);
}

/// Keeps the recorded poses, so that the same command continues from there. If the session
/// `continued` from kept poses and has none any more, they are removed, or they would come back.
int keep_for_later(const Wearer& wearer, const calibrate::CalibrationGuide& guide, bool continued) {
  const auto readings = guide.readings();
  std::error_code ignored;
  if (readings.empty()) {
    if (continued) fs::remove(unfinished_path(wearer), ignored);
    return 0;
  }
  fs::create_directories(wearer.path.parent_path(), ignored);
  const auto kept =
      calibrate::write_readings(unfinished_path(wearer), readings, guide.free_motion(),
                                wearer.about.side, wearer.about.counts);
  if (!kept) return cli::report(kept.error());
  cli::note((readings.size() == 1 ? "1 pose is" : std::to_string(readings.size()) + " poses are") +
            " kept; the same command continues from there, or with --fresh from the beginning");
  return 0;
}

int calibrate_glove(const Options& options) {
  const auto glove = gloves::open_glove(options.glove);
  if (!glove) return cli::report(glove.error());
  const driver::GloveInfo& info = (*glove)->info();
  Wearer wearer = describe(options, info.side, info.counts, info.sensors);
  wearer.about.glove_model = info.model;
  wearer.about.glove_serial = sculpting::serial_of(info);
  if (const auto fine = find_files(wearer, options); !fine) return cli::report(fine.error());
  calibrate::CalibrationGuide guide(poses_for(options), info.counts, options.stiff_sensors);
  std::error_code error;
  bool continued = false;
  if (!options.fresh && fs::exists(unfinished_path(wearer), error)) {
    const auto before = calibrate::read_capture(unfinished_path(wearer));
    if (!before)
      return cli::report(
          {before.error().code, before.error().message + "; use --fresh to replace it"});
    continued = before->counts == info.counts && before->side == info.side;
    if (continued) guide.restore(before->readings, before->free_motion);
    // What was found stuck before is not in the poses.
    for (const auto& reading : before->readings)
      if (continued) guide.leave_out({info.sensors.bits & ~reading.held.present.bits});
  }
  if (wearer.known) guide.leave_out(wearer.known->left_out);
  cli::install_stop_signals();
  const auto end = calibrate::run_calibration_session(
      **glove, options.user, fit_options(options, info.counts, wearer.known), guide);
  if (!end) return cli::report(end.error());
  if (*end == calibrate::SessionEnd::quit) return keep_for_later(wearer, guide, continued);
  note_left_out(options.glove, guide.left_out());
  const int code = fit_and_write(options, wearer, guide);
  return code == 0 ? 0 : (keep_for_later(wearer, guide, continued), code);
}

int calibrate(Options& options) {
  const auto stiff = sensors_of(options.stiff);
  if (!stiff) return cli::report(stiff.error());
  options.stiff_sensors = *stiff;
  if (const auto fine = check(options); !fine) return cli::report(fine.error());
  return options.from.empty() ? calibrate_glove(options) : calibrate_from_capture(options);
}

} // namespace
} // namespace nendo::app::calibrate_command

void nendo::app::add_calibrate(cli::Command& program) {
  using namespace calibrate_command;
  cli::Command command =
      program.add_command("calibrate", "Calibrates a glove to a wearer's hand, by guided poses");
  Options& options = command.on_chosen<Options>(calibrate_command::calibrate);
  command.add_option("GLOVE", options.glove, "serial:/dev/ttyUSB0, auto, ...");
  command.add_option("--user", options.user, "Name of the wearer");
  command.add_flag("--quick", options.quick, "Use only two poses: the flat hand and the fist");
  command.add_flag("--touch-up", options.touch_up,
                   "Adjust the existing calibration after the glove was put on again: a free "
                   "motion, flat hand, fist and pinches");
  command.add_option("--stiff", options.stiff,
                     "Fingers that cannot reach the poses, e.g. thumb,index, or wrist: they go as "
                     "far as they can, and only their flat hand is used");
  command.add_option("--from", options.from,
                     "A capture instead of a glove: the output of `nendo monitor --json` while the "
                     "poses are held one after another, three seconds each");
  command.add_millimetres("--hand-length", options.length_mm,
                          "Millimetres from the wrist's crease to the tip of the middle finger");
  command.add_millimetres("--hand-breadth", options.breadth_mm, "Millimetres across the knuckles");
  command.add_option("--out", options.out,
                     "Where to write the calibration; without it, where other commands find it");
  command.add_option("--picture", options.picture, "Also draw ranges and residuals, as FILE.svg");
  command.add_flag("--fresh", options.fresh, "Do not continue a session that was quit");
  std::string footer = "The poses, in their order:\n";
  for (const auto id : hand::full_poses())
    footer += "  " + std::string(hand::pose_of(id).name) + ": " +
              std::string(hand::pose_of(id).instruction) + "\n";
  footer += "Then again:";
  for (const auto id : hand::full_takes().subspan(hand::full_poses().size()))
    footer += " " + std::string(hand::pose_of(id).name);
  command.set_footer(footer + ".\nThe other commands use the calibration automatically; `nendo "
                              "calibration` lists, compares and exports calibrations.");
  add_calibrate_tracker(command);
}
