#include "calibrate/session.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <nendo/base/text.hpp>

#include "calibrate/guided_calibration.hpp"
#include "calibrate/hand_drawing.hpp"
#include "cli/cli.hpp"
#include "cli/terminal.hpp"
#include "gloves/monitor_screen.hpp"

namespace nendo::calibrate {
namespace {

constexpr std::chrono::milliseconds frame_time{50};

std::string with_keys(const GuideNotice& notice) {
  switch (notice.kind) {
  case GuideNotice::Kind::none:
    break;
  case GuideNotice::Kind::left_out:
    return notice.text + " n begins again with all sensors.";
  case GuideNotice::Kind::will_restart:
    return "n once more forgets every pose and restarts.";
  case GuideNotice::Kind::unfitted:
    return notice.text + " b goes back a pose; n restarts, and so does --fresh.";
  }
  return {};
}

/// Draws a guided calibration, and passes keys to it.
struct Session {
  GuidedCalibration guided;
  const std::string& user;
  cli::Terminal terminal{};

  void show() {
    const HostTime now = HostClock::now();
    const GloveSample* const latest = guided.latest();
    const CalibrationPicture picture{
        &guided.info(),          &user,
        &guided.guide(),         latest,
        &guided.seen(),          latest != nullptr ? to_seconds(now - latest->arrival) : 0.0,
        &guided.demonstration(), guided.has_begun(),
        guided.undetermined(),   with_keys(guided.notice())};
    terminal.draw(calibration_lines(picture, terminal.size()));
  }
  std::optional<SessionEnd> handle(char key) {
    if (key == 'q') return SessionEnd::quit;
    for (const GuideActionRow& row : guide_actions())
      if (row.key == key) {
        guided.act(row.action);
        return std::nullopt;
      }
    guided.dismiss_notice();
    return std::nullopt;
  }
  /// Waits for the fit of the poses: there is nothing to show until it is known how it ends.
  std::optional<SessionEnd> end() {
    guided.settle();
    if (!guided.end()) return std::nullopt;
    return *guided.end() == GuideEnd::complete ? SessionEnd::complete : SessionEnd::written;
  }
};

/// The keys and what they do, in one line.
std::string keys_line() {
  std::string line;
  for (const GuideActionRow& row : guide_actions())
    line += (row.key == ' ' ? std::string("SPACE") : std::string(1, row.key)) + ' ' +
            std::string(row.word) + "  ";
  return line + "q quit";
}

using hand::CaptureState;

constexpr int name_width = 23;
constexpr int min_bar = 8;
constexpr int drawing_rows = 16;
constexpr int min_drawing_rows = 10;
constexpr double silent_after_s = 1.0;

std::string fitted(std::string text, int width) {
  text.resize(static_cast<std::size_t>(std::max(width, 0)), ' ');
  return text;
}

/// Appends a text in lines of at most `width` characters, broken at blanks where it has some.
void add_wrapped(std::vector<std::string>& lines, const std::string& text, int width) {
  const auto most = static_cast<std::size_t>(std::max(width, 1));
  for (std::size_t at = text.find_first_not_of(' '); at < text.size();) {
    std::size_t end = text.size();
    if (end - at > most) {
      const std::size_t blank = text.rfind(' ', at + most);
      end = blank == std::string::npos || blank <= at ? at + most : blank;
    }
    const std::size_t last = text.find_last_not_of(' ', end - 1);
    lines.push_back(text.substr(at, last + 1 - at));
    at = text.find_first_not_of(' ', end);
  }
}

std::string state_text(const CalibrationPicture& picture) {
  const hand::PoseCapture& capture = picture.guide->capture();
  const auto troubled = [&] {
    const SensorMask sensors = capture.troubled();
    return std::string(sensors.bits == 0 ? "a sensor" : name_of(*sensors.begin()));
  };
  if (!picture.begun) return "Bend and stretch every joint fully, a few times. Then SPACE begins.";
  if (picture.sample == nullptr || picture.age_s > silent_after_s) return "The glove is silent.";
  switch (capture.state()) {
  case CaptureState::waiting:
    return "Waiting for the glove.";
  case CaptureState::moving:
    return "Hold still: " + troubled() + " moves.";
  case CaptureState::noisy:
    return "Too noisy: " + troubled() +
           " jumps to and fro. Does the glove sit well? If it goes "
           "on, x leaves the sensor out.";
  case CaptureState::saturated:
    return "At an end of its range: " + troubled() +
           ". Bend that joint less. If it stays there whatever you do, x leaves the sensor out.";
  case CaptureState::unchanged:
    if (picture.guide->implausible_sensor())
      return "That is not it: look at " +
             std::string(name_of(*picture.guide->implausible_sensor())) +
             ". If the pose before was not right, b takes it again; if the sensor is broken, x "
             "leaves "
             "it out.";
    return picture.guide->number() == 0 ? "Take this pose." : "Taken. Now take this one.";
  case CaptureState::settling:
  case CaptureState::held:
    break;
  }
  constexpr int width = 20;
  const int done = static_cast<int>(std::lround(capture.progress() * width));
  return "Good, hold it [" + std::string(static_cast<std::size_t>(done), '#') +
         std::string(static_cast<std::size_t>(width - done), '.') + "]";
}

std::string undetermined_text(SensorMask undetermined) {
  constexpr int max_names = 3;
  const int count = std::popcount(undetermined.bits);
  if (count == 0) return {};
  std::string names;
  int named = 0;
  for (std::size_t slot = 0; slot < sensor_slots && named < max_names; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    if (!undetermined.has(sensor)) continue;
    names += (named++ == 0 ? "" : ", ") + std::string(name_of(sensor));
  }
  if (count > named) names += " and " + std::to_string(count - named) + " more";
  return "Not known yet: " + names;
}

std::vector<std::string> bars(const CalibrationPicture& picture, int width, int rows) {
  std::vector<std::string> lines;
  if (picture.sample == nullptr || width < name_width + min_bar) return lines;
  for (const Sensor sensor : picture.sample->present) {
    if (static_cast<int>(lines.size()) >= rows) break;
    const bool left_out = picture.guide->left_out().has(sensor);
    lines.push_back(
        fitted((left_out ? "(" : "") + std::string(name_of(sensor)) + (left_out ? ")" : ""),
               name_width) +
        gloves::count_bar(width - name_width, (*picture.sample)[sensor].value,
                          (*picture.seen)[sensor], picture.info->counts.max_count));
  }
  return lines;
}

/// Returns two drawings and the bars beside each other, as far as they fit.
std::vector<std::string> middle(const CalibrationPicture& picture, int columns, int rows) {
  constexpr int min_columns = 22;
  const bool draws = rows >= min_drawing_rows && columns >= 2 * min_columns;
  const int drawn_rows = std::min(rows, drawing_rows);
  const int drawn = draws ? std::min(2 * drawn_rows, (columns - (name_width + min_bar)) / 2) : 0;
  std::vector<std::string> lines(static_cast<std::size_t>(std::max(rows, 0)));
  if (draws && drawn >= min_columns) {
    const hand::HandPose& pose = *picture.demonstration;
    const auto palm = draw_hand(pose, picture.info->side, HandView::palm, drawn, drawn_rows);
    const auto side = draw_hand(pose, picture.info->side, HandView::side, drawn, drawn_rows);
    for (std::size_t row = 0; row < palm.size(); ++row)
      lines[row] = palm[row] + side[row];
  }
  const int used = draws && drawn >= min_columns ? 2 * drawn : 0;
  const auto sensors = bars(picture, columns - used, rows);
  for (std::size_t row = 0; row < sensors.size(); ++row)
    lines[row] = fitted(lines[row], used) + sensors[row];
  return lines;
}

} // namespace

Result<SessionEnd> run_calibration_session(driver::Glove& glove, const std::string& user,
                                           const hand::FitOptions& fit, CalibrationGuide& guide) {
  Session session{GuidedCalibration(glove.info(), fit, guide), user};
  SampleRing ring(1024);
  if (const auto started = glove.start(ring); !started) return started.error();
  std::optional<SessionEnd> ended = session.end(); // kept poses may be all of them
  while (!ended) {
    GloveSample sample;
    while (ring.try_pop(sample))
      session.guided.push(sample);
    ended = session.end();
    if (ended) break;
    session.show();
    if (const auto key = session.terminal.key(frame_time)) ended = session.handle(*key);
    if (!ended) ended = session.end();
    if (cli::stop_requested() || session.terminal.is_gone()) ended = SessionEnd::quit;
  }
  session.terminal.leave();
  glove.stop();
  return *ended;
}

std::vector<std::string> calibration_lines(const CalibrationPicture& picture,
                                           cli::ScreenSize size) {
  const CalibrationGuide& guide = *picture.guide;
  const hand::CalibrationPose& pose = hand::pose_of(guide.asked());
  const std::string title =
      "Pose " + std::to_string(guide.number() + 1) + " of " + std::to_string(guide.pose_count()) +
      ": " + std::string(pose.name) + (guide.is_again() ? ", once more" : "") + "   (" +
      std::string(name_of(picture.info->side)) + " hand of " + printable(*picture.user) + ")";
  std::vector<std::string> lines{title};
  add_wrapped(lines, std::string(pose.instruction), size.columns);
  add_wrapped(lines, printable(picture.notice), size.columns);
  add_wrapped(lines, state_text(picture), size.columns);
  std::vector<std::string> below;
  add_wrapped(below, undetermined_text(picture.undetermined), size.columns);
  if (below.empty()) below.emplace_back(); // what is below stays where it is
  add_wrapped(below, keys_line(), size.columns);
  const int free_rows = size.rows - static_cast<int>(lines.size() + below.size());
  const auto between = middle(picture, size.columns, free_rows);
  lines.insert(lines.end(), between.begin(), between.end());
  lines.insert(lines.end(), below.begin(), below.end());
  for (auto& line : lines)
    if (static_cast<int>(line.size()) > size.columns)
      line.resize(static_cast<std::size_t>(std::max(size.columns, 0)));
  // Where rows are scarce the keys go last.
  while (static_cast<int>(lines.size()) > std::max(size.rows, 1))
    lines.erase(lines.end() - 2);
  return lines;
}

} // namespace nendo::calibrate
