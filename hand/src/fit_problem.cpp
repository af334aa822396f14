#include "fit_problem.hpp"

#include <algorithm>
#include <cmath>

#include <nendo/base/units.hpp>

#include "fit_priors.hpp"

namespace nendo::hand {
namespace {

double mix_deviation(std::size_t coupling) {
  const Sensor of = couplings[coupling].of;
  return of == Sensor::thumb_roll || of == Sensor::thumb_abduction ? thumb_mix_deviation
                                                                   : gap_mix_deviation;
}

std::size_t slot_of(Sensor sensor) {
  return static_cast<std::size_t>(sensor);
}

/// Of finger and thumb joints.
bool is_flexion(std::size_t slot) {
  const RangeEnds& ends = range_ends_of[slot];
  return ends.high_deviation_deg > 0.0 && ends.low_deviation_deg == 0.0;
}

/// The joints that these angles make. What no sensor measures follows the rules, which is had by
/// passing the angles through lines of gain 1; what is measured is taken without the soft stops,
/// for a loop that a hand has closed is closed by the joints as they are.
JointAngles joints_of(const SensorAngles& angles, SensorMask sensors) {
  Calibration passing;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    passing.sensors[slot] = {1.0, -angles[slot]};
  GloveSample sample;
  sample.present = sensors;
  JointAngles joints = joint_angles(sample, passing);
  const auto take = [&](double& joint_rad, Sensor sensor) {
    if (sensors.has(sensor)) joint_rad = angles[slot_of(sensor)];
  };
  take(joints.thumb_roll_rad, Sensor::thumb_roll);
  take(joints.thumb_mcp_flexion_rad, Sensor::thumb_mcp);
  take(joints.thumb_ip_flexion_rad, Sensor::thumb_ip);
  take(joints.thumb_abduction_rad, Sensor::thumb_abduction);
  take(joints.palm_arch_rad, Sensor::palm_arch);
  for (std::size_t f = 0; f < joints.fingers.size(); ++f) {
    const auto sensor = [&](Sensor of_index) {
      return static_cast<Sensor>(slot_of(of_index) + 4 * f);
    };
    take(joints.fingers[f].mcp_flexion_rad, sensor(Sensor::index_mcp));
    take(joints.fingers[f].pip_flexion_rad, sensor(Sensor::index_pip));
    take(joints.fingers[f].dip_flexion_rad, sensor(Sensor::index_dip));
  }
  double middle_ring = 0.0, ring_little = 0.0;
  take(joints[Finger::index].mcp_abduction_rad, Sensor::index_middle_abduction);
  take(middle_ring, Sensor::middle_ring_abduction);
  take(ring_little, Sensor::ring_pinky_abduction);
  joints[Finger::ring].mcp_abduction_rad = -middle_ring;
  joints[Finger::little].mcp_abduction_rad = -middle_ring - ring_little;
  return joints;
}

} // namespace

FitProblem::FitProblem(std::span<const PoseReading> readings, Side side, SensorMask sensors,
                       const FitOptions& options)
    : readings_(readings), full_(options.mode == FitMode::full), sensors_(sensors),
      skeleton_(side, options.size), start_(default_calibration(options.scale)),
      most_counts_(options.scale.most) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors_.has(static_cast<Sensor>(slot))) continue;
    double mean = 0.0;
    for (const auto& reading : readings_)
      mean += reading.held.mean_counts[slot] / static_cast<double>(readings_.size());
    const auto [gain, offset] = start_.sensors[slot];
    lines_[slot] = {gain, gain * (mean - offset),
                    gain * offset_deviation_of_range * options.scale.most, mean};
  }
  for (const auto& reading : readings_) {
    const CalibrationPose& pose = pose_of(reading.pose);
    auto& assumptions = assumptions_.emplace_back();
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      // Without couplings, a fist says nothing of the gaps between fingers.
      const bool speaks = full_ || is_flexion(slot) || reading.pose == PoseId::flat;
      if (sensors_.has(static_cast<Sensor>(slot)) && pose.assumed[slot].known() && speaks)
        assumptions.push_back({slot, pose.assumed[slot]});
    }
    const Eigen::Index touch = height_ + static_cast<Eigen::Index>(assumptions.size());
    const bool touches = full_ && pose.touch && usable(*pose.touch);
    rows_.push_back({height_, touch, touch + (touches ? 3 : 0)});
    height_ = rows_.back().end;
  }
  if (full_) find_range_ends(options.free_motion);
}

void FitProblem::find_range_ends(const CountRanges& free_motion) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    if (!sensors_.has(sensor) || !free_motion.present.has(sensor)) continue;
    double least = readings_.front().held.mean_counts[slot], most = least;
    for (const auto& reading : readings_) {
      least = std::min(least, reading.held.mean_counts[slot]);
      most = std::max(most, reading.held.mean_counts[slot]);
    }
    const auto [low_deg, low_deviation_deg, high_deg, high_deviation_deg] = range_ends_of[slot];
    const double short_of_poses = short_of_poses_rad / lines_[slot].gain;
    const double low = free_motion.low_counts[slot], high = free_motion.high_counts[slot];
    // Written so that a NaN is refused.
    if (low_deviation_deg > 0.0 && low >= 0.0 && low <= least + short_of_poses)
      range_ends_.push_back({slot, low, {from_degrees(low_deg), from_degrees(low_deviation_deg)}});
    if (high_deviation_deg > 0.0 && high <= most_counts_ && high >= most - short_of_poses)
      range_ends_.push_back(
          {slot, high, {from_degrees(high_deg), from_degrees(high_deviation_deg)}});
  }
  height_ += static_cast<Eigen::Index>(range_ends_.size());
}

std::vector<Eigen::Index> FitProblem::wearers_unknowns() const {
  std::vector<Eigen::Index> chosen;
  const bool touches = std::any_of(rows_.begin(), rows_.end(),
                                   [](const Rows& rows) { return rows.end > rows.touch; });
  for (std::size_t k = line_unknowns; k < habit_unknowns && touches; ++k)
    chosen.push_back(static_cast<Eigen::Index>(k));
  std::array<bool, sensor_slots> bent{};
  for (const auto& of_reading : assumptions_)
    for (const auto& [slot, assumed] : of_reading)
      bent[slot] = bent[slot] || (full_ && assumed.by_feel);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (bent[slot]) chosen.push_back(static_cast<Eigen::Index>(habit_of(slot)));
  return chosen;
}

bool FitProblem::usable(const Touch& touch) const noexcept {
  // What is filled in by rule is no measurement: a loop needs sensors all the way around.
  const bool whole = sensors_.has(Sensor::thumb_roll) && sensors_.has(Sensor::thumb_abduction) &&
                     sensors_.has(Sensor::thumb_mcp) && sensors_.has(Sensor::thumb_ip);
  switch (touch.with) {
  case Joint::index_tip:
    return whole && sensors_.has(Sensor::index_mcp) && sensors_.has(Sensor::index_pip);
  case Joint::middle_tip:
    return whole && sensors_.has(Sensor::middle_mcp) && sensors_.has(Sensor::middle_pip);
  case Joint::ring_tip:
    return whole && sensors_.has(Sensor::ring_mcp) && sensors_.has(Sensor::ring_pip);
  case Joint::little_tip:
    return whole && sensors_.has(Sensor::pinky_mcp) && sensors_.has(Sensor::pinky_pip);
  default:
    return whole;
  }
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

FitProblem::Flesh FitProblem::flesh_m(const Unknowns& at) noexcept {
  constexpr auto first = static_cast<Eigen::Index>(line_unknowns);
  return {pad_depth_m + pad_depth_deviation_m * at[first],
          pad_behind_tip_m + pad_behind_deviation_m * at[first + 1],
          palm_depth_m + palm_depth_deviation_m * at[first + 2]};
}

Eigen::Vector3d FitProblem::gap_m(const SensorAngles& angles, const Touch& touch,
                                  const Flesh& flesh_m) const {
  const HandPose pose = skeleton_.pose(joints_of(angles, sensors_), Eigen::Isometry3d::Identity());
  const Eigen::Vector3d pad(0.0, -flesh_m.pad_depth, flesh_m.pad_behind);
  const Eigen::Vector3d thumb = pose[Joint::thumb_tip] * pad;
  const bool finger =
      std::find(fingertips.begin(), fingertips.end(), touch.with) != fingertips.end();
  if (finger) return thumb - pose[touch.with] * pad;
  const auto metacarpal = static_cast<Joint>(index_of(touch.with) - 1);
  return thumb - pose[touch.with].translation() +
         flesh_m.palm_depth * pose[metacarpal].linear().col(1);
}

double FitProblem::gap_m(const Unknowns& at, std::size_t reading) const {
  const auto [begin, touch, end] = rows_[reading];
  if (end == touch) return 0.0;
  return gap_m(angles_rad(at, reading, nullptr), *pose_of(readings_[reading].pose).touch,
               flesh_m(at))
      .norm();
}

void FitProblem::add_assumptions(std::size_t reading, const Unknowns& at,
                                 const SensorAngles& angles, const AngleJacobian& by_unknowns,
                                 Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const {
  Eigen::Index row = rows_[reading].begin;
  for (const auto& [slot, assumed] : assumptions_[reading]) {
    // Two poses cannot tell a habit.
    const double habit_rad = full_ && assumed.by_feel ? habit_part * assumed.deviation_rad : 0.0;
    const double deviation_rad =
        std::sqrt(assumed.deviation_rad * assumed.deviation_rad - habit_rad * habit_rad);
    const auto habit = static_cast<Eigen::Index>(habit_of(slot));
    const double meant_rad = assumed.angle_rad + habit_rad * at[habit];
    const Robust result = robust((angles[slot] - meant_rad) / deviation_rad);
    residuals[row] = result.residual;
    if (jacobian != nullptr) {
      const double slope = result.slope / deviation_rad;
      jacobian->row(row).head<line_unknowns>() =
          slope * by_unknowns.row(static_cast<Eigen::Index>(slot));
      (*jacobian)(row, habit) = -slope * habit_rad;
    }
    ++row;
  }
}

void FitProblem::add_touch(std::size_t reading, const Unknowns& at, SensorAngles angles,
                           const AngleJacobian& by_unknowns, Eigen::VectorXd& residuals,
                           Eigen::MatrixXd* jacobian) const {
  const Eigen::Index row = rows_[reading].touch;
  const Touch& touch = *pose_of(readings_[reading].pose).touch;
  const Flesh flesh = flesh_m(at);
  const Eigen::Vector3d off = gap_m(angles, touch, flesh) / touch.deviation_m;
  Eigen::Vector3d slopes;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Robust result = robust(off[k]);
    residuals[row + k] = result.residual;
    slopes[k] = result.slope / touch.deviation_m;
  }
  if (jacobian == nullptr) return;
  constexpr double step_rad = 1e-5;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors_.has(static_cast<Sensor>(slot))) continue;
    const double angle = angles[slot];
    angles[slot] = angle + step_rad;
    const Eigen::Vector3d above = gap_m(angles, touch, flesh);
    angles[slot] = angle - step_rad;
    const Eigen::Vector3d slope = (above - gap_m(angles, touch, flesh)) / (2.0 * step_rad);
    angles[slot] = angle;
    jacobian->block<3, line_unknowns>(row, 0) +=
        slopes.cwiseProduct(slope) * by_unknowns.row(static_cast<Eigen::Index>(slot));
  }
  for (std::size_t k = line_unknowns; k < habit_unknowns; ++k) { // linear: any step will do
    Unknowns next = at;
    next[static_cast<Eigen::Index>(k)] += 1.0;
    jacobian->block<3, 1>(row, static_cast<Eigen::Index>(k)) =
        slopes.cwiseProduct(gap_m(angles, touch, flesh_m(next)) - off * touch.deviation_m);
  }
}

void FitProblem::add_range_ends(const Unknowns& at, Eigen::VectorXd& residuals,
                                Eigen::MatrixXd* jacobian) const {
  Eigen::Index row = height_ - static_cast<Eigen::Index>(range_ends_.size());
  for (const auto& [slot, counts, end] : range_ends_) {
    const Line now = line(at, slot);
    const double turn_rad = now.gain * (counts - now.mean_counts);
    const Robust result = robust((now.level + turn_rad - end.angle_rad) / end.deviation_rad);
    residuals[row] = result.residual;
    if (jacobian != nullptr) {
      const double slope = result.slope / end.deviation_rad;
      (*jacobian)(row, static_cast<Eigen::Index>(gain_of(slot))) =
          slope * gain_deviation * turn_rad;
      (*jacobian)(row, static_cast<Eigen::Index>(level_of(slot))) = slope * now.level_unit;
    }
    ++row;
  }
}

void FitProblem::evaluate(const Unknowns& at, Eigen::VectorXd& residuals,
                          Eigen::MatrixXd* jacobian) const {
  residuals.resize(height_);
  if (jacobian != nullptr) jacobian->setZero(height_, unknown_count);
  AngleJacobian by_unknowns;
  for (std::size_t n = 0; n < readings_.size(); ++n) {
    const SensorAngles angles = angles_rad(at, n, jacobian == nullptr ? nullptr : &by_unknowns);
    add_assumptions(n, at, angles, by_unknowns, residuals, jacobian);
    if (rows_[n].end > rows_[n].touch) add_touch(n, at, angles, by_unknowns, residuals, jacobian);
  }
  add_range_ends(at, residuals, jacobian);
}

template <class Visit>
void FitProblem::for_each_line(Visit&& visit) const {
  for (std::size_t n = 0; n < readings_.size(); ++n) {
    Eigen::Index row = rows_[n].begin;
    for (const Assumption& assumption : assumptions_[n])
      visit(row++, static_cast<Eigen::Index>(gain_of(assumption.slot)));
  }
  Eigen::Index row = height_ - static_cast<Eigen::Index>(range_ends_.size());
  for (const RangeEnd& end : range_ends_)
    visit(row++, static_cast<Eigen::Index>(gain_of(end.slot)));
}

void FitProblem::weigh_as(const Unknowns& before, const Unknowns& at, double part,
                          Eigen::VectorXd& residuals) const {
  for_each_line([&](Eigen::Index row, Eigen::Index gain) {
    residuals[row] *= std::exp(part * gain_deviation * (before[gain] - at[gain]));
  });
}

void FitProblem::hold_weights(const Eigen::VectorXd& residuals, double part,
                              Eigen::MatrixXd& jacobian) const {
  for_each_line([&](Eigen::Index row, Eigen::Index gain) {
    jacobian(row, gain) -= part * gain_deviation * residuals[row];
  });
}

} // namespace nendo::hand
