// nendo calibrate: makes a calibration from a wearer's poses.

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <unistd.h>

#include <nendo/base/text.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "calibrate/capture_file.hpp"
#include "calibrate/report.hpp"
#include "calibrate/session.hpp"
#include "calibrate/still_sensors.hpp"
#include "calibrate/wearer_file.hpp"
#include "cli/cli.hpp"
#include "gloves/open_hand.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"
#ifdef NENDO_WINDOW
#include "studio/calibration_screen.hpp"
#endif

namespace nendo::app::calibrate_command {
namespace {

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
  bool view = false;
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
  if (options.view && !options.from.empty())
    return Error{Errc::usage, "--view and --from cannot be combined; give one of them"};
  if (options.user.empty() && !options.view)
    return Error{Errc::usage, "--user is missing: name the wearer, e.g. --user anna"};
  if (auto fine = gloves::HandLength{options.length_mm}.check(); !fine) return fine;
  if (!(options.breadth_mm >= 50.0 && options.breadth_mm <= 130.0))
    return Error{Errc::usage, "--hand-breadth: use 50 to 130 millimetres, across the knuckles"};
  const bool at_terminal = ::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0;
  if (options.from.empty() && !options.view && !at_terminal)
    return Error{Errc::usage, "the guided calibration needs a terminal, or a screen with --view; "
                              "elsewhere use --from FILE"};
  return {};
}

hand::HandSize size_of(const Options& options) {
  return {1e-3 * options.length_mm, 1e-3 * options.breadth_mm};
}

calibrate::CalibrationRequest request_of(const Options& options) {
  using calibrate::CalibrationKind;
  const CalibrationKind kind = options.touch_up ? CalibrationKind::touch_up
                               : options.quick  ? CalibrationKind::quick
                                                : CalibrationKind::full;
  return {options.user, kind, size_of(options), options.stiff_sensors, options.out};
}

void note_left_out(const std::string& source, SensorMask left_out) {
  if (left_out.bits == 0) return;
  const bool one = sculpting::is_one(left_out);
  cli::note(printable(source) + ": " + sculpting::sensors_in_words(left_out) +
            (one ? " is" : " are") + " stuck, so the calibration is made without " +
            (one ? "it" : "them") + ", and the joint is estimated from neighbouring sensors");
}

/// Reports what was written. Returns the exit code.
int report_result(const Options& options, const calibrate::FinishedCalibration& finished,
                  const std::filesystem::path& path, const std::filesystem::path& earlier) {
  calibrate::print_report(std::cout, finished.fit, finished.readings, finished.sensors,
                          finished.wearer.left_out);
  std::cout << "wrote " << printable(path.string()) << '\n';
  if (!earlier.empty())
    std::cout << "the previous one is kept as " << printable(earlier.string()) << '\n';
  if (options.picture.empty()) return 0;
  const auto drawn = calibrate::write_report_picture(options.picture, finished.fit, finished.wearer,
                                                     finished.sensors);
  if (!drawn) return cli::report(drawn.error());
  report_written(options.picture);
  return 0;
}

int fit_and_write(const Options& options, const calibrate::WearerFile& file,
                  const calibrate::CalibrationGuide& guide) {
  const auto finished = file.fit(guide);
  if (!finished) return cli::report(finished.error());
  const auto earlier = file.write(*finished);
  if (!earlier) return cli::report(earlier.error());
  return report_result(options, *finished, file.path(), *earlier);
}

/// Returns the sensors that are found stuck anywhere in a capture.
SensorMask stuck_in(const calibrate::CaptureFile& capture, calibrate::CalibrationGuide guide) {
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
  SensorMask sensors;
  for (const auto& reading : capture->readings)
    sensors.bits |= reading.held.present.bits;
  for (const GloveSample& sample : capture->samples)
    sensors.bits |= sample.present.bits;
  const auto file =
      calibrate::WearerFile::find(request_of(options), {capture->side, capture->counts, sensors});
  if (!file) return cli::report(file.error());
  calibrate::CalibrationGuide guide = file->guide();
  guide.restore(capture->readings, capture->free_motion);
  guide.leave_out(calibrate::still_in(capture->readings, capture->counts));
  // A sensor may be found late. It is left out from the beginning.
  guide.leave_out(stuck_in(*capture, guide));
  note_left_out(options.from, guide.left_out());
  bool noted = false; // a pose that was missed shifts all later ones, so one note is enough
  for (const GloveSample& sample : capture->samples) {
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
  return fit_and_write(options, *file, guide);
}

void note_kept(std::size_t poses) {
  if (poses == 0) return;
  cli::note((poses == 1 ? "1 pose is" : std::to_string(poses) + " poses are") +
            " kept; the same command continues from there, or with --fresh from the beginning");
}

/// Keeps the recorded poses, so that the same command continues from there.
int keep_for_later(const calibrate::WearerFile& file, const calibrate::CalibrationGuide& guide) {
  const auto kept = file.keep(guide);
  if (!kept) return cli::report(kept.error());
  note_kept(*kept);
  return 0;
}

#ifdef NENDO_WINDOW
int calibrate_in_window(const Options& options) {
  auto window = viewer::SceneWindow::open(
      "Nendo", {}, "on a box without a screen calibrate at a terminal, without --view");
  if (!window) return cli::report(window.error());
  const auto glove = gloves::open_glove(options.glove);
  if (!glove) return cli::report(glove.error());
  studio::CalibrationScreen screen(**glove, request_of(options), options.fresh);
  if (const auto started = screen.start(); !started) return cli::report(started.error());
  std::optional<Result<studio::CalibrationOutcome>> outcome;
  while (!outcome) {
    if (cli::stop_requested() || (*window)->take_close_request()) screen.leave();
    outcome = screen.show(**window);
  }
  if (!*outcome) return cli::report(outcome->error());
  const studio::CalibrationOutcome& result = **outcome;
  note_kept(result.kept);
  if (!result.finished) return 0;
  note_left_out(options.glove, result.finished->wearer.left_out);
  const int code = report_result(options, *result.finished, result.written, result.earlier);
  if (result.adapt)
    cli::note("to keep learning while you work: nendo run --adapt --user " +
              printable(result.finished->wearer.user));
  return code;
}
#else
int calibrate_in_window(const Options&) {
  return cli::report({Errc::failed, "--view: this nendo was built without a window; calibrate at a "
                                    "terminal, without --view"});
}
#endif

int calibrate_glove(const Options& options) {
  const auto glove = gloves::open_glove(options.glove);
  if (!glove) return cli::report(glove.error());
  auto file = calibrate::WearerFile::find(request_of(options),
                                          calibrate::calibrated_glove((*glove)->info()));
  if (!file) return cli::report(file.error());
  calibrate::CalibrationGuide guide = file->guide();
  if (!options.fresh)
    if (const auto restored = file->restore(guide); !restored)
      return cli::report(
          {restored.error().code, restored.error().message + "; use --fresh to replace it"});
  cli::install_stop_signals();
  const auto end =
      calibrate::run_calibration_session(**glove, options.user, file->fit_options(), guide);
  if (!end) return cli::report(end.error());
  if (*end == calibrate::SessionEnd::quit) return keep_for_later(*file, guide);
  note_left_out(options.glove, guide.left_out());
  const int code = fit_and_write(options, *file, guide);
  return code == 0 ? 0 : (keep_for_later(*file, guide), code);
}

int calibrate(Options& options) {
  const auto stiff = sensors_of(options.stiff);
  if (!stiff) return cli::report(stiff.error());
  options.stiff_sensors = *stiff;
  if (const auto fine = check(options); !fine) return cli::report(fine.error());
  if (options.view) return calibrate_in_window(options);
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
  command.add_flag("--view", options.view,
                   "In a window instead of the terminal, with a hand to follow, and a try at the "
                   "end; asks for what is not given");
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
