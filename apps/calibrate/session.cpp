#include "calibrate/session.hpp"

#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include <nendo/sculpting/calibration_names.hpp>

#include "calibrate/demonstration.hpp"
#include "calibrate/screen.hpp"
#include "cli/cli.hpp"
#include "cli/terminal.hpp"
#include "gloves/monitor_screen.hpp"

namespace nendo::calibrate {
namespace {

constexpr std::chrono::milliseconds frame_time{50};

/// The state of a session.
struct Session {
  driver::Glove& glove;
  const std::string& user;
  const hand::FitOptions& fit;
  CalibrationGuide& guide;
  SampleRing ring{1024};
  cli::Terminal terminal{};
  gloves::SeenCounts seen{};
  std::optional<GloveSample> latest{};
  SensorMask undetermined{};
  bool begun = false;
  std::string notice{};         ///< why there is no calibration yet; stays until something is done
  SensorMask announced{};       ///< the sensors left out that the wearer knows of
  bool asks_to_restart = false; ///< the key that restarts was pressed once
  struct Demonstration {
    hand::PoseId of;
    hand::HandPose pose;
  };
  std::optional<Demonstration> shown{};

  void take_samples() {
    GloveSample sample;
    while (ring.try_pop(sample)) {
      seen.add(sample);
      latest = sample;
      if (!begun) guide.push_free_motion(sample);
      const bool captured = begun && guide.push(sample) == CalibrationGuide::Event::captured;
      if (captured) notice.clear();
      const bool left_out = report_left_out();
      if (captured || left_out) update_undetermined();
    }
  }
  /// Says which sensors are left out, if there are more than before.
  bool report_left_out() {
    const SensorMask now = guide.left_out();
    if (std::exchange(announced, now) == now) return false;
    notice = sculpting::sensors_in_words(now) + (sculpting::is_one(now) ? " is" : " are") +
             " stuck, whatever the hand does: left out, and estimated from the sensors beside. n "
             "begins again with all sensors.";
    return true;
  }
  /// The sensors of which a calibration is made.
  SensorMask sensors() const { return {glove.info().sensors.bits & ~guide.left_out().bits}; }
  /// Leaves out what keeps a pose from being taken, as the wearer asks.
  void leave_out_troubled() {
    const auto state = guide.capture().state();
    if (begun && guide.implausible_sensor()) {
      SensorMask sensor;
      sensor.add(*guide.implausible_sensor());
      return guide.leave_out(sensor);
    }
    if (!begun || (state != hand::CaptureState::saturated && state != hand::CaptureState::noisy))
      return;
    guide.leave_out(guide.capture().troubled());
  }
  Result<hand::CalibrationFit> fitted() const {
    const auto readings = guide.readings();
    hand::FitOptions options = fit;
    options.free_motion = guide.free_motion();
    options.hold_out = false; // between two poses the wearer would wait for that
    return hand::fit_calibration(readings, glove.info().side, sensors(), options);
  }
  void update_undetermined() {
    const auto found = fitted();
    undetermined = found ? found->undetermined : sensors();
  }
  /// Ends the session if a calibration fits the poses. Otherwise asks for a pose: without one,
  /// neither this session nor one that continues from its poses would have a way on.
  std::optional<SessionEnd> finish(SessionEnd end) {
    const auto found = fitted();
    if (found) return end;
    notice = "No calibration yet: " + found.error().message +
             ". b goes back a pose; n restarts, and so does --fresh.";
    if (guide.is_done()) guide.go_back();
    update_undetermined();
    return std::nullopt;
  }
  /// Forgets what was taken, if asked to twice in a row.
  void restart(bool asked_before) {
    if (!asked_before) {
      asks_to_restart = true;
      notice = "n once more forgets every pose and restarts.";
      return;
    }
    guide.reset();
    announced = {};
    seen.clear();
    begun = false;
  }
  const hand::HandPose& demonstration() {
    const hand::PoseId asked = guide.asked();
    if (!shown || shown->of != asked) shown = {asked, demonstrated(asked, glove.info().side)};
    return shown->pose;
  }
  void show() {
    const HostTime now = HostClock::now();
    const CalibrationPicture picture{&glove.info(),
                                     &user,
                                     &guide,
                                     latest ? &*latest : nullptr,
                                     &seen,
                                     latest ? to_seconds(now - latest->arrival) : 0.0,
                                     &demonstration(),
                                     begun,
                                     begun ? undetermined : SensorMask{},
                                     notice};
    terminal.draw(calibration_lines(picture, terminal.size()));
  }
  std::optional<SessionEnd> handle(char key) {
    const bool asked_again = std::exchange(asks_to_restart, false);
    notice.clear();
    if (key == 'q') return SessionEnd::quit;
    if (key == 'w') return finish(SessionEnd::written);
    if (key == 'n') restart(asked_again);
    if (key == ' ' && !std::exchange(begun, true)) guide.end_free_motion();
    if (key == 'x') leave_out_troubled();
    report_left_out();
    if (key == 'b') guide.go_back();
    if (key == 't') guide.take_again();
    if (key == 's') guide.skip();
    if (key == 'b' || key == 's' || key == 'n' || key == 'x') update_undetermined();
    return std::nullopt;
  }
};

} // namespace

Result<SessionEnd> run_calibration_session(driver::Glove& glove, const std::string& user,
                                           const hand::FitOptions& fit, CalibrationGuide& guide) {
  Session session{glove, user, fit, guide};
  if (const auto started = glove.start(session.ring); !started) return started.error();
  session.report_left_out();
  session.update_undetermined();
  std::optional<SessionEnd> ended;
  while (!ended) {
    session.take_samples();
    if (guide.is_done()) ended = session.finish(SessionEnd::complete);
    if (ended) break;
    session.show();
    if (const auto key = session.terminal.key(frame_time)) ended = session.handle(*key);
    if (cli::stop_requested() || session.terminal.is_gone()) ended = SessionEnd::quit;
  }
  session.terminal.leave();
  glove.stop();
  return *ended;
}

} // namespace nendo::calibrate
