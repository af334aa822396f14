#include "studio/calibration_course.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
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

CalibrationCourse::CalibrationCourse(driver::Glove& glove, calibrate::CalibrationRequest request,
                                     bool fresh)
    : glove_(glove), side_(glove.info().side), request_(std::move(request)), fresh_(fresh),
      length_mm_(static_cast<float>(1e3 * request_.size.length_m)),
      recent_names_(names_in_store()) {
  follow_name();
}

CalibrationCourse::~CalibrationCourse() {
  glove_.stop();
}

Result<void> CalibrationCourse::start() {
  return glove_.start(ring_);
}

/// Finds what there is of the wearer whose name was typed.
void CalibrationCourse::follow_name() {
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

void CalibrationCourse::begin_guide() {
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
  kept_poses_ = guide.readings();
  guide_ = std::move(guide);
  guided_.emplace(glove_.info(), file_->fit_options(), *guide_);
  guiding_since_ = HostClock::now();
  stage_ = Stage::guiding;
}

bool CalibrationCourse::has_unkept_poses() const {
  if (!guide_ || !guide_->has_any() || outcome_) return false;
  const auto is_same = [](const hand::PoseReading& one, const hand::PoseReading& other) {
    return one.pose == other.pose && one.held.mean_counts == other.held.mean_counts;
  };
  return !std::ranges::equal(guide_->readings(), kept_poses_, is_same);
}

void CalibrationCourse::take_samples() {
  GloveSample sample;
  while (ring_.try_pop(sample)) {
    latest_ = sample;
    if (stage_ != Stage::guiding) continue;
    guided_->push(sample);
    guided_->update(); // a guide that is done is ending from now on
  }
}

void CalibrationCourse::advance() {
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
  skeleton_.emplace(side_, finished_->fit.size);
  nearest_m_ = {};
  problem_.clear();
  stage_ = Stage::after;
}

void CalibrationCourse::begin_last_fit() {
  fitting_ = std::async(std::launch::async,
                        [file = &*file_, guide = *guide_] { return file->fit(guide); });
  stage_ = Stage::fitting;
}

void CalibrationCourse::take_again() {
  const std::size_t worst = calibrate::worst_reading(*finished_);
  std::size_t reading = 0;
  for (std::size_t number = 0; number < guide_->pose_count(); ++number)
    if (guide_->is_kept(number) && reading++ == worst) {
      guided_->ask_for(number);
      break;
    }
  stage_ = Stage::guiding;
}

void CalibrationCourse::keep_result() {
  const auto earlier = file_->write(*finished_);
  if (!earlier) {
    problem_ = earlier.error().message;
    return;
  }
  outcome_.emplace(CalibrationOutcome{std::move(finished_), file_->path(), *earlier, 0, adapt_});
}

void CalibrationCourse::discard() {
  file_->forget_kept();
  outcome_.emplace(CalibrationOutcome{});
}

void CalibrationCourse::leave() {
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

hand::JointAngles CalibrationCourse::live_angles(const hand::Calibration& calibration) const {
  const SensorMask left_out = guide_ ? guide_->left_out() : SensorMask{};
  return hand::joint_angles(*latest_, calibration, left_out);
}

/// Returns the share of joints that have moved over half their usual range.
double CalibrationCourse::shown_ranges() const {
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
std::string CalibrationCourse::trouble() const {
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

CourseWords CalibrationCourse::guide_words() const {
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

CourseWords CalibrationCourse::words() const {
  switch (stage_) {
  case Stage::before:
    if (!latest_) return {"The glove is silent.", "Is it switched on, and plugged in?", true};
    return {"Put the glove on, and move your hand.",
            "This hand moves with it, but does not fit yet. Choose who you are, and press Start."};
  case Stage::guiding:
    return guide_words();
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

void CalibrationCourse::update() {
  take_samples();
  advance();
  picture_ = {};
  hand::PoseId pose = hand::PoseId::fist;
  if (stage_ == Stage::guiding && guided_->has_begun() && !guided_->is_ending())
    pose = guide_->asked();
  if (stage_ == Stage::after) pose = hand::PoseId::pinch_little;
  picture_.view = view_of(pose, side_);
  picture_.width_m = stage_ == Stage::after ? two_hands_m : one_hand_m;
  pose_hands();
  picture_.words = words();
  picture_.warns = stage_ == Stage::guiding && guided_->has_begun() && !advice_.empty();
}

void CalibrationCourse::pose_hands() {
  switch (stage_) {
  case Stage::before:
    if (latest_)
      add_live(hand::HandSkeleton(side_).pose(
          live_angles(hand::default_calibration(glove_.info().counts)), upright()));
    break;
  case Stage::guiding:
    if (guided_->is_ending()) break;
    guided_->has_begun() ? pose_asked() : pose_free_motion();
    picture_.ring = guided_->has_begun() ? guide_->capture().progress() : shown_ranges();
    break;
  case Stage::fitting:
    break;
  case Stage::after:
    pose_result();
    break;
  }
}

void CalibrationCourse::add_live(const hand::HandPose& pose, const Fingers& marked, bool is_wrong) {
  picture_.hands.push_back({pose, ShownHand::Look::live, marked, is_wrong});
}

void CalibrationCourse::pose_free_motion() {
  const hand::HandSkeleton skeleton(side_);
  const double time_s = to_seconds(HostClock::now() - guiding_since_);
  if (latest_) add_live(skeleton.pose(live_angles(guided_->calibration()), upright()));
  picture_.hands.push_back({skeleton.pose(free_motion(time_s), upright()), ShownHand::Look::ghost});
}

void CalibrationCourse::pose_asked() {
  const hand::HandSkeleton skeleton(side_); // as large as the demonstrated hand
  const hand::HandPose asked = moved(guided_->demonstration(), upright());
  advice_.clear();
  const ShownHand ghost{asked, ShownHand::Look::ghost};
  if (!latest_) return picture_.hands.push_back(ghost);
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
  add_live(live, marked, true);
  picture_.hands.push_back(ghost);
  picture_.ways = ways(live, asked, marked);
}

void CalibrationCourse::pose_result() {
  render::Camera camera;
  camera.view = picture_.view;
  const Eigen::Vector3d right = camera.axes().row(0).transpose();
  picture_.aside_m = aside_m * right;
  const hand::HandPose report =
      moved(render::HandSkin::bind_pose(side_), upright(-picture_.aside_m));
  picture_.hands.push_back({report, ShownHand::Look::glass});
  for (const Sensor sensor : glove_.info().sensors)
    picture_.joints.push_back(
        {sensor, place_of(sensor, report), calibrate::certainty_of(*finished_, sensor)});
  if (!latest_) return;
  const hand::JointAngles angles = live_angles(finished_->wearer.calibration);
  const Eigen::Isometry3d wrist = upright(picture_.aside_m);
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
  add_live(live, touching);
}

} // namespace nendo::studio
