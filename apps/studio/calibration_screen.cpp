#include "studio/calibration_screen.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include <nendo/hand/calibration_store.hpp>
#include <nendo/hand/pinch_closing.hpp>

namespace nendo::studio {

using calibrate::CalibrationKind;
using calibrate::GuideNotice;
using hand::CaptureState;
using hand::Joint;

namespace {

constexpr double one_hand_m = 0.24;
constexpr double two_hands_m = 0.46;

hand::HandPose moved(hand::HandPose pose, const Eigen::Isometry3d& by) {
  for (Eigen::Isometry3d& joint : pose.joints)
    joint = by * joint;
  return pose;
}

/// Returns a hand that goes through the motion of all joints, at a time in seconds.
hand::JointAngles free_motion(double time_s) {
  constexpr double period_s = 3.2;
  const double bend = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * time_s / period_s);
  const double wrist = std::sin(2.0 * std::numbers::pi * time_s / (2.0 * period_s));
  constexpr std::array<double, 4> spread_rad{0.30, 0.04, -0.24, -0.50};
  hand::JointAngles angles;
  for (std::size_t finger = 0; finger < 4; ++finger)
    angles.fingers[finger] = {1.5 * bend, (1.0 - bend) * spread_rad[finger], 1.7 * bend,
                              1.0 * bend};
  angles.thumb_abduction_rad = 0.75 * (1.0 - bend) + 0.25;
  angles.thumb_roll_rad = 0.2 + 0.9 * bend;
  angles.thumb_mcp_flexion_rad = 0.7 * bend;
  angles.thumb_ip_flexion_rad = 0.9 * bend;
  angles.wrist_pitch_rad = 0.5 * wrist;
  return angles;
}

std::vector<std::string> names_in_store() {
  constexpr std::size_t most = 6;
  auto files = hand::list_calibrations(hand::calibration_folders()).files;
  std::stable_sort(files.begin(), files.end(), [](const auto& one, const auto& other) {
    return one.wearer.made > other.wearer.made;
  });
  std::vector<std::string> names;
  for (const hand::StoredCalibration& file : files)
    if (names.size() < most &&
        std::find(names.begin(), names.end(), file.wearer.user) == names.end())
      names.push_back(file.wearer.user);
  return names;
}

} // namespace

CalibrationScreen::CalibrationScreen(driver::Glove& glove, calibrate::CalibrationRequest request,
                                     bool fresh)
    : glove_(glove), painter_(glove.info().side), request_(std::move(request)), fresh_(fresh),
      length_mm_(static_cast<float>(1e3 * request_.size.length_m)),
      recent_names_(names_in_store()) {
  request_.user.copy(name_.data(), name_.size() - 1);
  follow_name();
  camera_.view = view_of(hand::PoseId::fist, painter_.side());
}

CalibrationScreen::~CalibrationScreen() {
  glove_.stop();
}

Result<void> CalibrationScreen::start() {
  return glove_.start(ring_);
}

/// Finds what there is of the wearer whose name was typed.
void CalibrationScreen::follow_name() {
  request_.user = name_.data();
  touch_up_refusal_ = "Type a name first.";
  has_kept_ = false;
  problem_.clear();
  if (request_.user.empty()) return;
  const calibrate::CalibratedGlove glove = calibrate::calibrated_glove(glove_.info());
  calibrate::CalibrationRequest known = request_;
  known.kind = CalibrationKind::touch_up;
  touch_up_refusal_ = calibrate::WearerFile::find(known, glove)
                          ? ""
                          : request_.user + " has no calibration of this glove yet.";
  if (request_.kind == CalibrationKind::touch_up && !touch_up_refusal_.empty())
    request_.kind = CalibrationKind::quick;
  const auto file = calibrate::WearerFile::find(request_, glove);
  has_kept_ = file && !fresh_ && file->has_kept();
}

void CalibrationScreen::begin_guide() {
  const hand::HandSize average;
  const double length_m = 1e-3 * static_cast<double>(length_mm_);
  if (std::abs(length_m - request_.size.length_m) > 0.5e-3) {
    request_.size.breadth_m = length_m / average.length_m * average.breadth_m;
    request_.size.length_m = length_m;
  }
  auto file = calibrate::WearerFile::find(request_, calibrate::calibrated_glove(glove_.info()));
  if (!file) {
    problem_ = file.error().message;
    return;
  }
  calibrate::CalibrationGuide guide = file->guide();
  if (has_kept_ && continues_)
    if (const auto restored = file->restore(guide); !restored) {
      problem_ = restored.error().message;
      return;
    }
  file_ = *std::move(file);
  guide_ = std::move(guide);
  guided_.emplace(glove_.info(), file_->fit_options(), *guide_);
  guiding_since_ = HostClock::now();
  stage_ = Stage::guiding;
}

void CalibrationScreen::take_samples() {
  GloveSample sample;
  while (ring_.try_pop(sample)) {
    latest_ = sample;
    if (stage_ != Stage::guiding) continue;
    guided_->push(sample);
    guided_->update(); // a guide that is done is ending from now on
  }
}

void CalibrationScreen::advance() {
  using namespace std::chrono_literals;
  if (stage_ == Stage::guiding) {
    guided_->update();
    if (guided_->end()) begin_last_fit();
  }
  if (stage_ != Stage::fitting || fitting_.wait_for(0s) != std::future_status::ready) return;
  auto done = fitting_.get();
  if (!done) {
    problem_ = done.error().message;
    stage_ = Stage::guiding;
    guided_->ask_for(guide_->pose_count() - 1);
    return;
  }
  finished_ = *std::move(done);
  findings_ = calibrate::findings(*finished_, request_.kind);
  skeleton_.emplace(glove_.info().side, finished_->fit.size);
  nearest_m_ = {};
  problem_.clear();
  stage_ = Stage::after;
}

void CalibrationScreen::begin_last_fit() {
  fitting_ = std::async(std::launch::async,
                        [file = &*file_, guide = *guide_] { return file->fit(guide); });
  stage_ = Stage::fitting;
}

void CalibrationScreen::take_again() {
  const std::size_t worst = calibrate::worst_reading(*finished_);
  std::size_t reading = 0;
  for (std::size_t number = 0; number < guide_->pose_count(); ++number)
    if (guide_->is_kept(number) && reading++ == worst) {
      guided_->ask_for(number);
      break;
    }
  stage_ = Stage::guiding;
}

void CalibrationScreen::keep_result() {
  const auto earlier = file_->write(*finished_);
  if (!earlier) {
    problem_ = earlier.error().message;
    return;
  }
  outcome_.emplace(CalibrationOutcome{std::move(finished_), file_->path(), *earlier, 0, adapt_});
}

void CalibrationScreen::leave() {
  if (outcome_) return;
  CalibrationOutcome left;
  left.adapt = adapt_;
  if (file_) {
    const auto kept = file_->keep(*guide_);
    if (!kept) {
      outcome_.emplace(kept.error());
      return;
    }
    left.kept = *kept;
  }
  outcome_.emplace(std::move(left));
}

hand::JointAngles CalibrationScreen::live_angles(const hand::Calibration& calibration) const {
  const SensorMask left_out = guide_ ? guide_->left_out() : SensorMask{};
  return hand::joint_angles(*latest_, calibration, left_out);
}

/// Returns the share of joints that have moved over half their usual range.
double CalibrationScreen::shown_ranges() const {
  const hand::CountRanges seen = guide_->free_motion();
  const hand::Calibration usual = hand::default_calibration(glove_.info().counts);
  const hand::Calibration ranges = hand::default_calibration({1, true});
  int all = 0, moved = 0;
  for (const Sensor sensor : glove_.info().sensors) {
    const std::size_t slot = index_of(sensor);
    if (guide_->left_out().has(sensor) || usual[sensor].gain_rad_per_count == 0.0) continue;
    ++all;
    if (!seen.present.has(sensor)) continue;
    const double span_rad =
        usual[sensor].gain_rad_per_count * (seen.high_counts[slot] - seen.low_counts[slot]);
    if (span_rad > 0.5 * ranges[sensor].gain_rad_per_count) ++moved;
  }
  return all == 0 ? 1.0 : static_cast<double>(moved) / all;
}

/// Returns what keeps the pose from being right, in words; empty if nothing does.
std::string CalibrationScreen::trouble() const {
  if (!advice_.empty()) return advice_.front().text + ".";
  const hand::PoseCapture& capture = guide_->capture();
  const std::string sensor = capture.troubled().bits == 0
                                 ? "a sensor"
                                 : std::string(calibrate::in_words(*capture.troubled().begin()));
  if (capture.state() == CaptureState::noisy)
    return "Too noisy: " + sensor +
           ". Does the glove sit well? Leave sensor out continues without it.";
  if (capture.state() == CaptureState::saturated)
    return "At an end of its range: " + sensor +
           ". Bend it less. If it stays there, leave the sensor out.";
  if (capture.state() == CaptureState::unchanged && guide_->implausible_sensor())
    return "That is not it: look at the " +
           std::string(calibrate::in_words(*guide_->implausible_sensor())) +
           ". If the pose before was not right, press Back.";
  return {};
}

CalibrationScreen::Banner CalibrationScreen::guide_banner() const {
  if (guided_->is_ending()) return {"All poses are taken.", "Computing ..."};
  if (guided_->is_silent(HostClock::now()))
    return {"The glove is silent.", "Is it switched on, and plugged in?", true};
  if (!guided_->has_begun())
    return {"Bend and stretch every joint as far as you can, a few times.",
            shown_ranges() < 0.8 ? "Do as the blue hand does, with the wrist and the thumb as well."
                                 : "Enough joints have shown how far they go. Press Begin."};
  const std::string instruction(hand::pose_of(guide_->asked()).instruction);
  if (const std::string wrong = trouble(); !wrong.empty()) return {instruction, wrong, true};
  switch (guide_->capture().state()) {
  case CaptureState::moving:
    return {instruction, "Take the blue hand's pose, and hold still."};
  case CaptureState::settling:
  case CaptureState::held:
    return {instruction, "Good, hold it."};
  case CaptureState::unchanged:
    return {instruction,
            guide_->has_any() ? "Taken. Now take this pose." : "Take the blue hand's pose."};
  default:
    return {instruction, "Waiting for the glove."};
  }
}

CalibrationScreen::Banner CalibrationScreen::banner() const {
  switch (stage_) {
  case Stage::before:
    if (!latest_) return {"The glove is silent.", "Is it switched on, and plugged in?", true};
    return {"Put the glove on, and move your hand.",
            "This hand moves with it, but does not fit yet. Choose who you are, and press Start."};
  case Stage::guiding:
    return guide_banner();
  case Stage::fitting:
    return {"All poses are taken.", "Computing ..."};
  case Stage::after:
    break;
  }
  const auto ticked = std::count_if(nearest_m_.begin(), nearest_m_.end(),
                                    [](const auto& gap_m) { return gap_m && *gap_m <= touch_m; });
  if (ticked == 4) return {"It fits.", "Press Keep to use this calibration from now on."};
  return {"Try it: touch the thumb with each finger in turn.",
          "The hand on the right shall do the same. Then press Keep."};
}

void CalibrationScreen::look_by(viewer::SceneWindow& window) {
  const HostTime now = HostClock::now();
  const double elapsed_s = drawn_ == HostTime{} ? 1.0 : to_seconds(now - drawn_);
  drawn_ = now;
  const render::Size size = window.scene_size();
  const double free_width = std::max(1, size.width - covered_px());
  hand::PoseId pose = hand::PoseId::fist;
  if (stage_ == Stage::guiding && guided_->has_begun() && !guided_->is_ending())
    pose = guide_->asked();
  if (stage_ == Stage::after) pose = hand::PoseId::pinch_little;
  const render::View wanted = view_of(pose, painter_.side());
  turn_towards(camera_, wanted, elapsed_s);
  window.leave_left(covered_px());
  window.leave_below(0);
  window.look_by(camera_for(camera_.view, stage_ == Stage::after ? two_hands_m : one_hand_m,
                            free_width / size.height));
}

void CalibrationScreen::add_live(viewer::SceneWindow& window, const hand::HandPose& pose,
                                 const Fingers& marked, bool is_wrong) {
  for (render::Surface& surface : painter_.live(pose, marked, is_wrong))
    window.add(std::move(surface));
}

void CalibrationScreen::draw_free_motion(viewer::SceneWindow& window) {
  const hand::HandSkeleton skeleton(painter_.side());
  const double time_s = to_seconds(HostClock::now() - guiding_since_);
  if (latest_)
    add_live(window, skeleton.pose(live_angles(guided_->calibration()), upright()), {}, false);
  window.add(painter_.ghost(skeleton.pose(free_motion(time_s), upright())));
}

void CalibrationScreen::draw_asked_pose(viewer::SceneWindow& window) {
  const hand::HandSkeleton skeleton(painter_.side()); // as large as the demonstrated hand
  const hand::HandPose asked = moved(guided_->demonstration(), upright());
  window.add(painter_.ghost(asked));
  advice_.clear();
  if (!latest_) return;
  const hand::JointAngles angles = live_angles(guided_->calibration());
  const SensorMask measured{latest_->present.bits & ~guide_->left_out().bits};
  // A hand that is still in the previous pose has done nothing wrong.
  const bool was_taken = guide_->capture().state() == CaptureState::unchanged &&
                         !guide_->implausible_sensor() && guide_->has_any();
  if (!was_taken)
    advice_ = calibrate::advise(guide_->asked(), angles, skeleton, measured,
                                guided_->is_fitted() ? calibrate::Trust::fitted
                                                     : calibrate::Trust::typical);
  Fingers marked{};
  for (const calibrate::PoseAdvice& advice : advice_)
    for (std::size_t finger = 0; finger < marked.size(); ++finger)
      marked[finger] = marked[finger] || advice.fingers[finger];
  const hand::HandPose live = skeleton.pose(angles, upright());
  add_live(window, live, marked, true);
  if (render::Surface ways = arrows(live, asked, marked); !ways.is_empty())
    window.add(std::move(ways));
}

void CalibrationScreen::draw_result(viewer::SceneWindow& window) {
  const Eigen::Vector3d right = window.camera().axes().row(0).transpose();
  report_pose_ = moved(render::HandSkin::bind_pose(painter_.side()), upright(-aside_m * right));
  const SensorMask sensors = glove_.info().sensors;
  for (render::Surface& surface : painter_.report(report_pose_, *finished_, sensors))
    window.add(std::move(surface));
  if (!latest_) return;
  const hand::JointAngles angles = live_angles(finished_->wearer.calibration);
  const Eigen::Isometry3d wrist = upright(aside_m * right);
  // As a run shows it: pads that are near each other meet.
  const hand::HandPose live = skeleton_->pose(
      hand::close_pinches(angles, *skeleton_, latest_->present, guide_->left_out()), wrist);
  Fingers touching{};
  for (std::size_t finger = 1; finger < hand::finger_count; ++finger) {
    const double gap_m = (live[Joint::thumb_tip] * skeleton_->pad() -
                          live[hand::fingertips[finger]] * skeleton_->pad())
                             .norm();
    auto& nearest_m = nearest_m_[finger - 1];
    nearest_m = std::min(gap_m, nearest_m.value_or(gap_m));
    if (gap_m <= touch_m) touching[0] = touching[finger] = true;
  }
  add_live(window, live, touching, false);
}

void CalibrationScreen::draw_scene(viewer::SceneWindow& window) {
  switch (stage_) {
  case Stage::before:
    if (latest_)
      add_live(window,
               hand::HandSkeleton(painter_.side())
                   .pose(live_angles(hand::default_calibration(glove_.info().counts)), upright()),
               {}, false);
    break;
  case Stage::guiding:
    if (guided_->is_ending()) break;
    guided_->has_begun() ? draw_asked_pose(window) : draw_free_motion(window);
    break;
  case Stage::fitting:
    break;
  case Stage::after:
    draw_result(window);
    break;
  }
}

std::optional<Result<CalibrationOutcome>> CalibrationScreen::show(viewer::SceneWindow& window) {
  take_samples();
  advance();
  look_by(window);
  if (window.has_model()) window.clear_model();
  window.begin_picture({});
  draw_scene(window);
  draw_panel(window);
  draw_banner(window);
  if (stage_ == Stage::guiding) draw_ring(window);
  if (stage_ == Stage::after) draw_captions(window);
  window.end_picture();
  if (window.take_close_request()) leave();
  return std::move(outcome_);
}

} // namespace nendo::studio
