#include "calibrate/wearer_file.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <system_error>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_store.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "calibrate/capture_file.hpp"

namespace nendo::calibrate {

namespace fs = std::filesystem;

CalibratedGlove calibrated_glove(const driver::GloveInfo& info) {
  return {info.side, info.counts, info.sensors, info.model, sculpting::serial_of(info)};
}

Result<WearerFile> WearerFile::find(const CalibrationRequest& request,
                                    const CalibratedGlove& glove) {
  WearerFile file;
  file.request_ = request;
  file.sensors_ = glove.sensors;
  hand::WearerCalibration& about = file.about_;
  about.user = request.user;
  about.glove_model = glove.model;
  about.glove_serial = glove.serial;
  about.side = glove.side;
  about.counts = glove.counts;
  about.size = request.size;
  about.method = request.kind == CalibrationKind::quick ? "quick" : "full";
  about.made = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  file.path_ = request.out;
  const bool touches_up = request.kind == CalibrationKind::touch_up;
  if (!request.out.empty() && !touches_up) return file;
  const auto stored = hand::own_calibration_path(request.user, glove.serial, glove.side);
  if (!stored) return stored.error();
  if (request.out.empty()) file.path_ = *stored;
  if (!touches_up) return file;
  if (const auto begun = file.begin_with_known(*stored); !begun) return begun.error();
  return file;
}

Result<void> WearerFile::begin_with_known(const fs::path& stored) {
  std::error_code error;
  if (!fs::exists(stored, error))
    return Error{Errc::bad_input, printable(stored.string()) +
                                      ": no calibration to touch up; calibrate without --touch-up"};
  auto known = hand::read_calibration(stored);
  if (!known) return known.error();
  if (known->counts != about_.counts)
    return Error{Errc::bad_input,
                 printable(stored.string()) +
                     ": is for another kind of glove; calibrate without --touch-up"};
  const auto made = about_.made;
  known_ = *known;
  known->made = made;
  constexpr std::string_view mark = ", touched up";
  if (!known->method.ends_with(mark)) known->method += mark;
  about_ = *std::move(known);
  return {};
}

std::span<const hand::PoseId> WearerFile::poses() const noexcept {
  if (request_.kind == CalibrationKind::touch_up) return hand::touch_up_poses();
  return request_.kind == CalibrationKind::quick ? hand::quick_poses() : hand::full_takes();
}

hand::FitOptions WearerFile::fit_options() const {
  hand::FitOptions fitting;
  fitting.stiff = request_.stiff;
  fitting.scale = about_.counts;
  if (known_) {
    fitting.mode = hand::FitMode::touch_up;
    fitting.size = known_->size;
    fitting.start = hand::calibration_for(*known_, about_.counts);
    fitting.start_ends = hand::reached_ends(*known_);
    return fitting;
  }
  fitting.mode =
      request_.kind == CalibrationKind::quick ? hand::FitMode::quick : hand::FitMode::full;
  fitting.size = request_.size;
  const hand::HandSize average;
  fitting.size_known =
      fitting.size.length_m != average.length_m || fitting.size.breadth_m != average.breadth_m;
  return fitting;
}

CalibrationGuide WearerFile::guide() const {
  CalibrationGuide guide(poses(), about_.counts, request_.stiff);
  if (known_) guide.leave_out(known_->left_out);
  return guide;
}

fs::path WearerFile::kept_path() const {
  return path_.string() + (known_ ? ".touch-up.unfinished" : ".unfinished");
}

bool WearerFile::has_kept() const {
  std::error_code error;
  return fs::exists(kept_path(), error);
}

Result<void> WearerFile::restore(CalibrationGuide& guide) {
  if (!has_kept()) return {};
  const auto before = read_capture(kept_path());
  if (!before) return before.error();
  restored_ = before->counts == about_.counts && before->side == about_.side;
  if (!restored_) return {};
  guide.restore(before->readings, before->free_motion);
  // What was found stuck before is not in the poses.
  for (const auto& reading : before->readings)
    guide.leave_out({sensors_.bits & ~reading.held.present.bits});
  return {};
}

void WearerFile::forget_kept() const {
  std::error_code ignored;
  fs::remove(kept_path(), ignored);
}

Result<std::size_t> WearerFile::keep(const CalibrationGuide& guide) const {
  const auto readings = guide.readings();
  if (readings.empty()) {
    if (restored_) forget_kept(); // or they would come back
    return readings.size();
  }
  std::error_code ignored;
  fs::create_directories(path_.parent_path(), ignored);
  const auto kept =
      write_readings(kept_path(), readings, guide.free_motion(), about_.side, about_.counts);
  if (!kept) return kept.error();
  return readings.size();
}

/// How well a sensor's line is known, and how far the wearer went, in poses or in free motion. A
/// touch-up changes only where that lies.
void WearerFile::note_quality(FinishedCalibration& finished, const hand::CountRanges& free_motion,
                              std::size_t slot) const {
  auto& quality = finished.wearer.quality[slot];
  const hand::SensorFit& sensor = finished.fit.sensors[slot];
  if (known_) {
    const double slipped = finished.fit.calibration.sensors[slot].offset_counts -
                           known_->calibration.sensors[slot].offset_counts;
    if (quality) hand::move_ends(*quality, slipped, finished.wearer.counts);
    return;
  }
  const bool known = sensor.gain_determined && sensor.offset_determined;
  quality = hand::SensorQuality{sensor.residual_rad, sensor.low_counts, sensor.high_counts,
                                known ? 1.0 : 0.0};
  if (!free_motion.present.has(static_cast<Sensor>(slot))) return;
  quality->min_counts = std::min(quality->min_counts, free_motion.low_counts[slot]);
  quality->max_counts = std::max(quality->max_counts, free_motion.high_counts[slot]);
}

Result<FinishedCalibration> WearerFile::fit(const CalibrationGuide& guide) const {
  FinishedCalibration finished;
  finished.readings = guide.readings();
  finished.sensors = {sensors_.bits & ~guide.left_out().bits};
  hand::FitOptions fitting = fit_options();
  fitting.free_motion = guide.free_motion();
  auto fit = hand::fit_calibration(finished.readings, about_.side, finished.sensors, fitting);
  if (!fit) return fit.error();
  finished.fit = *std::move(fit);
  finished.wearer = about_;
  finished.wearer.left_out = guide.left_out();
  finished.wearer.calibration = finished.fit.calibration;
  finished.wearer.size = finished.fit.size;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (finished.sensors.has(static_cast<Sensor>(slot))) {
      note_quality(finished, fitting.free_motion, slot);
    } else { // a touch-up may begin with a line of it
      finished.wearer.calibration.sensors[slot] = {};
      finished.wearer.quality[slot].reset();
    }
  }
  return finished;
}

Result<fs::path> WearerFile::write(const FinishedCalibration& finished) const {
  auto earlier = hand::write_calibration(path_, finished.wearer);
  if (earlier) forget_kept();
  return earlier;
}

} // namespace nendo::calibrate
