#include "calibrate/guided_calibration.hpp"

#include <array>
#include <chrono>
#include <utility>

#include <nendo/hand/range_adaptation.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "calibrate/demonstration.hpp"

namespace nendo::calibrate {
namespace {

constexpr std::array<GuideActionRow, 7> action_rows{{
    {GuideAction::begin, ' ', "begin", "Begin",
     "The ranges of all joints were shown; the poses begin."},
    {GuideAction::back, 'b', "redo", "Back", "Forgets the last pose, and asks for it again."},
    {GuideAction::take_more, 't', "take more", "Take more",
     "Takes the last pose once more; both takes count."},
    {GuideAction::skip, 's', "skip", "Skip",
     "Continues without this pose. Flat hand and fist are asked for again at the end."},
    {GuideAction::leave_out, 'x', "leave out", "Leave sensor out",
     "Continues without the sensor that keeps this pose from being taken, as if it were broken."},
    {GuideAction::restart, 'n', "restart", "Start again",
     "Forgets every pose, and begins again. Needs to be asked for twice."},
    {GuideAction::finish, 'w', "write", "Finish now",
     "Makes the calibration from the poses taken so far."},
}};

/// Where a flat hand was held and no fist yet, its joints are at the angles of a flat hand.
void shift_to_flat(const CalibrationGuide& guide, hand::Calibration& calibration) {
  for (const hand::PoseReading& reading : guide.readings()) {
    if (reading.pose != hand::PoseId::flat) continue;
    for (const Sensor sensor : reading.held.present) {
      const std::size_t slot = index_of(sensor);
      const hand::AssumedAngle& assumed = hand::pose_of(reading.pose).assumed[slot];
      hand::SensorCalibration& line = calibration.sensors[slot];
      if (assumed.known() && line.gain_rad_per_count != 0.0)
        line.offset_counts =
            reading.held.mean_counts[slot] - assumed.angle_rad / line.gain_rad_per_count;
    }
  }
}

} // namespace

std::span<const GuideActionRow> guide_actions() noexcept {
  return action_rows;
}

GuidedCalibration::GuidedCalibration(const driver::GloveInfo& info, hand::FitOptions fit,
                                     CalibrationGuide& guide)
    : info_(&info), options_(std::move(fit)), guide_(&guide) {
  options_.hold_out = false; // between two poses the wearer would wait for that
  undetermined_ = sensors();
  report_left_out();
}

void GuidedCalibration::push(const GloveSample& sample) {
  seen_.add(sample);
  latest_ = sample;
  if (!begun_) guide_->push_free_motion(sample);
  const bool captured = begun_ && guide_->push(sample) == CalibrationGuide::Event::captured;
  if (captured) dismiss_notice();
  const bool left_out = report_left_out();
  if (captured || left_out) poses_changed();
}

/// Says which sensors are left out, if there are more than before.
bool GuidedCalibration::report_left_out() {
  const SensorMask now = guide_->left_out();
  if (std::exchange(announced_, now) == now) return false;
  notice_ = {
      GuideNotice::Kind::left_out,
      sculpting::sensors_in_words(now) + (sculpting::is_one(now) ? " is" : " are") +
          " stuck, whatever the hand does: left out, and estimated from the sensors beside."};
  return true;
}

SensorMask GuidedCalibration::sensors() const noexcept {
  return {info_->sensors.bits & ~guide_->left_out().bits};
}

bool GuidedCalibration::is_silent(HostTime now) const noexcept {
  constexpr double silent_after_s = 1.0;
  return !latest_ || to_seconds(now - latest_->arrival) > silent_after_s;
}

/// Leaves out what keeps a pose from being taken, as the wearer asks.
void GuidedCalibration::leave_out_troubled() {
  const auto state = guide_->capture().state();
  if (begun_ && guide_->implausible_sensor()) {
    SensorMask sensor;
    sensor.add(*guide_->implausible_sensor());
    return guide_->leave_out(sensor);
  }
  if (!begun_ || (state != hand::CaptureState::saturated && state != hand::CaptureState::noisy))
    return;
  guide_->leave_out(guide_->capture().troubled());
}

/// Forgets what was taken, if asked to twice in a row.
void GuidedCalibration::restart(bool asked_before) {
  if (!asked_before) {
    notice_.kind = GuideNotice::Kind::will_restart;
    return;
  }
  guide_->reset();
  announced_ = {};
  seen_.clear();
  begun_ = false;
  fit_.reset();
}

void GuidedCalibration::act(GuideAction action) {
  if (is_ending() || end_) return;
  const bool asked_again = notice_.kind == GuideNotice::Kind::will_restart;
  dismiss_notice();
  switch (action) {
  case GuideAction::begin:
    if (!std::exchange(begun_, true)) guide_->end_free_motion();
    break;
  case GuideAction::back:
    guide_->go_back();
    break;
  case GuideAction::take_more:
    guide_->take_again();
    break;
  case GuideAction::skip:
    guide_->skip();
    break;
  case GuideAction::leave_out:
    leave_out_troubled();
    break;
  case GuideAction::restart:
    restart(asked_again);
    break;
  case GuideAction::finish:
    wanted_ = GuideEnd::written;
    break;
  }
  const bool left_out = report_left_out();
  if (left_out || (action != GuideAction::take_more && action != GuideAction::finish))
    poses_changed();
}

void GuidedCalibration::ask_for(std::size_t number) {
  if (is_ending()) return;
  dismiss_notice();
  end_.reset();
  guide_->ask_for(number);
  poses_changed();
}

void GuidedCalibration::begin_fit() {
  is_stale_ = false;
  hand::FitOptions options = options_;
  options.free_motion = guide_->free_motion();
  running_ = std::async(std::launch::async, [readings = guide_->readings(), side = info_->side,
                                             sensors = sensors(), options = std::move(options)] {
    return hand::fit_calibration(readings, side, sensors, options);
  });
}

void GuidedCalibration::update() {
  using namespace std::chrono_literals;
  if (guide_->is_done() && !end_ && !wanted_) wanted_ = GuideEnd::complete;
  if (running_.valid() && running_.wait_for(0s) == std::future_status::ready) {
    auto done = running_.get();
    if (!is_stale_) {
      undetermined_ = done ? done->undetermined : sensors();
      if (done) fit_ = *done;
      result_ = std::move(done);
    }
  }
  if (is_stale_ && !running_.valid()) begin_fit();
  if (result_ && wanted_) conclude(*std::exchange(wanted_, std::nullopt));
}

void GuidedCalibration::settle() {
  for (update(); running_.valid(); update())
    running_.wait();
}

/// Ends the guide if a calibration fits the poses. Otherwise asks for a pose: without one, neither
/// this session nor one that continues from its poses would have a way on.
void GuidedCalibration::conclude(GuideEnd end) {
  if (*result_) {
    end_ = end;
    return;
  }
  notice_ = {GuideNotice::Kind::unfitted, "No calibration yet: " + result_->error().message + "."};
  if (!guide_->is_done()) return;
  guide_->go_back();
  poses_changed();
}

const hand::HandPose& GuidedCalibration::demonstration() {
  const hand::PoseId asked = guide_->asked();
  if (!shown_ || shown_->of != asked) shown_ = {asked, demonstrated(asked, info_->side)};
  return shown_->pose;
}

hand::Calibration GuidedCalibration::calibration() const {
  if (fit_) return fit_->calibration;
  if (options_.start) return *options_.start;
  hand::Calibration calibration = hand::default_calibration(info_->counts);
  if (!begun_) return calibration;
  const hand::CountRanges ends = guide_->free_motion();
  for (const Sensor sensor : ends.present) {
    const std::size_t slot = index_of(sensor);
    hand::SensorCalibration& line = calibration.sensors[slot];
    const hand::SensorCalibration learned =
        hand::line_of(slot, {ends.low_counts[slot], ends.high_counts[slot], 1});
    // A joint that went less far than half its range has not shown its ends.
    if (learned.gain_rad_per_count > 0.0 &&
        learned.gain_rad_per_count < 2.0 * line.gain_rad_per_count)
      line = learned;
  }
  shift_to_flat(*guide_, calibration);
  return calibration;
}

} // namespace nendo::calibrate
