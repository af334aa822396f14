#include "calibrate/session.hpp"

#include <chrono>
#include <optional>
#include <vector>

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
      if (begun && guide.push(sample) == CalibrationGuide::Event::captured) update_undetermined();
    }
  }
  void update_undetermined() {
    const auto readings = guide.readings();
    const auto sensors = glove.info().sensors;
    hand::FitOptions options = fit;
    options.free_motion = guide.free_motion();
    const auto fitted = hand::fit_calibration(readings, glove.info().side, sensors, options);
    undetermined = fitted ? fitted->undetermined : sensors;
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
                                     begun ? undetermined : SensorMask{}};
    terminal.draw(calibration_lines(picture, terminal.size()));
  }
  std::optional<SessionEnd> handle(char key) {
    if (key == 'q') return SessionEnd::quit;
    if (key == 'w') return SessionEnd::written;
    if (key == ' ') begun = true;
    if (key == 'b') guide.go_back();
    if (key == 't') guide.take_again();
    if (key == 's') guide.skip();
    if (key == 'b' || key == 's') update_undetermined();
    return std::nullopt;
  }
};

} // namespace

Result<SessionEnd> run_calibration_session(driver::Glove& glove, const std::string& user,
                                           const hand::FitOptions& fit, CalibrationGuide& guide) {
  Session session{glove, user, fit, guide};
  if (const auto started = glove.start(session.ring); !started) return started.error();
  session.update_undetermined();
  SessionEnd end = SessionEnd::complete;
  while (!guide.is_done()) {
    session.take_samples();
    if (guide.is_done()) break;
    session.show();
    std::optional<SessionEnd> ended;
    if (const auto key = session.terminal.key(frame_time)) ended = session.handle(*key);
    if (cli::stop_requested() || session.terminal.is_gone()) ended = SessionEnd::quit;
    if (!ended) continue;
    end = *ended;
    break;
  }
  session.terminal.leave();
  glove.stop();
  return end;
}

} // namespace nendo::calibrate
