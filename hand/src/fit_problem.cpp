#include "fit_problem.hpp"

#include <cmath>

namespace nendo::hand {
namespace {

// What the default leaves open. Published gains and offsets differ by half of this between gloves
// and wearers, so that a pose or two outweigh it.
constexpr double gain_deviation = 0.5; ///< of the gain's logarithm: its sign is known
constexpr double offset_deviation_of_range = 40.0 / 255.0;
// Thumb sensors mix strongly; published slope matrices have ratios up to 0.9.
constexpr double thumb_mix_deviation = 0.5;
constexpr double gap_mix_deviation = 0.2;

double mix_deviation(std::size_t coupling) {
  const Sensor of = couplings[coupling].of;
  return of == Sensor::thumb_roll || of == Sensor::thumb_abduction ? thumb_mix_deviation
                                                                   : gap_mix_deviation;
}

std::size_t slot_of(Sensor sensor) {
  return static_cast<std::size_t>(sensor);
}

bool is_flexion(std::size_t slot) {
  switch (static_cast<Sensor>(slot)) {
  case Sensor::thumb_mcp:
  case Sensor::thumb_ip:
  case Sensor::index_mcp:
  case Sensor::index_pip:
  case Sensor::index_dip:
  case Sensor::middle_mcp:
  case Sensor::middle_pip:
  case Sensor::middle_dip:
  case Sensor::ring_mcp:
  case Sensor::ring_pip:
  case Sensor::ring_dip:
  case Sensor::pinky_mcp:
  case Sensor::pinky_pip:
  case Sensor::pinky_dip:
    return true;
  default:
    return false;
  }
}

/// The joints that these angles make, by the rules for what no sensor measures: they pass through
/// lines of gain 1.
JointAngles joints_of(const SensorAngles& angles, SensorMask sensors) {
  Calibration passing;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    passing.sensors[slot] = {1.0, -angles[slot]};
  GloveSample sample;
  sample.present = sensors;
  return joint_angles(sample, passing);
}

} // namespace

FitProblem::FitProblem(std::span<const PoseReading> readings, Side side, SensorMask sensors,
                       const FitOptions& options)
    : readings_(readings), sensors_(sensors), skeleton_(side, options.size),
      start_(default_calibration(options.scale)) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors_.has(static_cast<Sensor>(slot))) continue;
    double mean = 0.0;
    for (const auto& reading : readings_)
      mean += reading.held.mean_counts[slot] / static_cast<double>(readings_.size());
    const auto [gain, offset] = start_.sensors[slot];
    lines_[slot] = {gain, gain * (mean - offset),
                    gain * offset_deviation_of_range * options.scale.most, mean};
  }
  const bool full = options.mode == FitMode::full;
  Eigen::Index row = 0;
  for (const auto& reading : readings_) {
    const CalibrationPose& pose = pose_of(reading.pose);
    auto& assumptions = assumptions_.emplace_back();
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      // Without couplings, a fist says nothing of the gaps between fingers.
      const bool speaks = full || is_flexion(slot) || reading.pose == PoseId::flat;
      if (sensors_.has(static_cast<Sensor>(slot)) && pose.assumed[slot].known() && speaks)
        assumptions.push_back({slot, pose.assumed[slot]});
    }
    const Eigen::Index touch = row + static_cast<Eigen::Index>(assumptions.size());
    const bool touches = full && pose.touch && usable(*pose.touch);
    rows_.push_back({row, touch, touch + (touches ? 3 : 0)});
    row = rows_.back().end;
  }
}

bool FitProblem::usable(const Touch& touch) const noexcept {
  // What is filled in by rule is no measurement: a loop needs sensors all the way around.
  const bool whole = sensors_.has(Sensor::thumb_roll) && sensors_.has(Sensor::thumb_abduction) &&
                     sensors_.has(Sensor::thumb_mcp) && sensors_.has(Sensor::thumb_ip);
  const bool index = touch.with == Joint::index_tip;
  return whole && sensors_.has(index ? Sensor::index_mcp : Sensor::middle_mcp) &&
         sensors_.has(index ? Sensor::index_pip : Sensor::middle_pip);
}

FitProblem::Line FitProblem::line(const Unknowns& at, std::size_t slot) const noexcept {
  Line line = lines_[slot];
  line.gain *= std::exp(gain_deviation * at[static_cast<Eigen::Index>(gain_of(slot))]);
  line.level += line.level_unit * at[static_cast<Eigen::Index>(level_of(slot))];
  return line;
}

Calibration FitProblem::calibration(const Unknowns& at) const {
  Calibration fitted = start_;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const Line now = line(at, slot);
    if (now.gain != 0.0) fitted.sensors[slot] = {now.gain, now.mean_counts - now.level / now.gain};
  }
  for (std::size_t k = 0; k < couplings.size(); ++k)
    fitted.mixed_in[k] += mix_deviation(k) * at[static_cast<Eigen::Index>(mix_of(k))];
  return fitted;
}

SensorAngles FitProblem::angles_rad(const Unknowns& at, std::size_t reading,
                                    AngleJacobian* jacobian) const {
  const auto& counts = readings_[reading].held.mean_counts;
  SensorAngles own{};
  if (jacobian != nullptr) jacobian->setZero();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors_.has(static_cast<Sensor>(slot))) continue;
    const Line now = line(at, slot);
    own[slot] = now.level + now.gain * (counts[slot] - now.mean_counts);
    if (jacobian == nullptr) continue;
    const auto row = static_cast<Eigen::Index>(slot);
    (*jacobian)(row, static_cast<Eigen::Index>(gain_of(slot))) =
        gain_deviation * now.gain * (counts[slot] - now.mean_counts);
    (*jacobian)(row, static_cast<Eigen::Index>(level_of(slot))) = now.level_unit;
  }
  SensorAngles angles = own;
  AngleJacobian mixed;
  if (jacobian != nullptr) mixed = *jacobian;
  for (std::size_t k = 0; k < couplings.size(); ++k) {
    const auto [of, by] = couplings[k];
    if (!sensors_.has(of) || !sensors_.has(by)) continue;
    const auto column = static_cast<Eigen::Index>(mix_of(k));
    const double mix = start_.mixed_in[k] + mix_deviation(k) * at[column];
    angles[slot_of(of)] += mix * own[slot_of(by)];
    if (jacobian == nullptr) continue;
    const auto row = static_cast<Eigen::Index>(slot_of(of));
    mixed.row(row) += mix * jacobian->row(static_cast<Eigen::Index>(slot_of(by)));
    mixed(row, column) += mix_deviation(k) * own[slot_of(by)];
  }
  if (jacobian != nullptr) *jacobian = mixed;
  return angles;
}

Eigen::Vector3d FitProblem::gap_m(const SensorAngles& angles, const Touch& touch) const {
  const HandPose pose = skeleton_.pose(joints_of(angles, sensors_), Eigen::Isometry3d::Identity());
  const Eigen::Vector3d pad(0.0, -pad_depth_m, pad_behind_tip_m);
  return pose[Joint::thumb_tip] * pad - pose[touch.with] * pad;
}

void FitProblem::evaluate(const Unknowns& at, Eigen::VectorXd& residuals,
                          Eigen::MatrixXd* jacobian) const {
  const Eigen::Index height = rows_.empty() ? 0 : rows_.back().end;
  residuals.resize(height);
  if (jacobian != nullptr) jacobian->setZero(height, unknown_count);
  AngleJacobian by_unknowns;
  for (std::size_t n = 0; n < readings_.size(); ++n) {
    SensorAngles angles = angles_rad(at, n, jacobian == nullptr ? nullptr : &by_unknowns);
    Eigen::Index row = rows_[n].begin;
    for (const auto& [slot, assumed] : assumptions_[n]) {
      residuals[row] = (angles[slot] - assumed.angle_rad) / assumed.deviation_rad;
      if (jacobian != nullptr) {
        jacobian->row(row) =
            by_unknowns.row(static_cast<Eigen::Index>(slot)) / assumed.deviation_rad;
      }
      ++row;
    }
    if (rows_[n].end == rows_[n].touch) continue;
    const Touch& touch = *pose_of(readings_[n].pose).touch;
    residuals.segment<3>(row) = gap_m(angles, touch) / touch.deviation_m;
    if (jacobian == nullptr) continue;
    constexpr double step_rad = 1e-5;
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      if (!sensors_.has(static_cast<Sensor>(slot))) continue;
      const double angle = angles[slot];
      angles[slot] = angle + step_rad;
      const Eigen::Vector3d above = gap_m(angles, touch);
      angles[slot] = angle - step_rad;
      const Eigen::Vector3d slope = (above - gap_m(angles, touch)) / (2.0 * step_rad);
      angles[slot] = angle;
      jacobian->middleRows<3>(row) +=
          slope / touch.deviation_m * by_unknowns.row(static_cast<Eigen::Index>(slot));
    }
  }
}

} // namespace nendo::hand
