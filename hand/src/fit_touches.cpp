// The part of the problem that is about touches, and so about the wearer's hand.

#include <algorithm>
#include <cmath>

#include "fit_priors.hpp"
#include "fit_problem.hpp"

namespace nendo::hand {
namespace {

// The step of an unknown of the hand, for derivatives by differences.
constexpr double hand_step = 1e-4;

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
    if (sensors.has(sensor)) joint_rad = angles[index_of(sensor)];
  };
  take(joints.thumb_roll_rad, Sensor::thumb_roll);
  take(joints.thumb_mcp_flexion_rad, Sensor::thumb_mcp);
  take(joints.thumb_ip_flexion_rad, Sensor::thumb_ip);
  take(joints.thumb_abduction_rad, Sensor::thumb_abduction);
  take(joints.palm_arch_rad, Sensor::palm_arch);
  for (std::size_t f = 0; f < joints.fingers.size(); ++f) {
    const auto& own = finger_sensors[f];
    take(joints.fingers[f].mcp_flexion_rad, own[0]);
    take(joints.fingers[f].pip_flexion_rad, own[1]);
    take(joints.fingers[f].dip_flexion_rad, own[2]);
  }
  double middle_ring = 0.0, ring_little = 0.0;
  take(joints[Finger::index].mcp_abduction_rad, Sensor::index_middle_abduction);
  take(middle_ring, Sensor::middle_ring_abduction);
  take(ring_little, Sensor::ring_little_abduction);
  joints[Finger::ring].mcp_abduction_rad = -middle_ring;
  joints[Finger::little].mcp_abduction_rad = -middle_ring - ring_little;
  return joints;
}

} // namespace

HandSize FitProblem::size(const Unknowns& at) const {
  HandSize size = start_size_;
  // Far steps of the search must not lead to hands that cannot be.
  const auto scale = [&](Eigen::Index unknown, double deviation) {
    return std::exp(std::clamp(deviation * at[unknown], -0.4, 0.4));
  };
  if (fits_hand(hand_unknowns)) {
    const double longer = scale(hand_unknowns, length_deviation);
    size.length_m *= longer;
    size.breadth_m *= longer * scale(hand_unknowns + 1, breadth_deviation);
  }
  for (std::size_t k = 0; k < shape_terms && fits_hand(shape_unknowns); ++k) {
    const auto term = static_cast<ShapeTerm>(k);
    const double unknown = at[shape_unknowns + static_cast<Eigen::Index>(k)];
    size.shape.terms[k] = std::clamp(size.shape.terms[k] + shape_deviation(term) * unknown,
                                     -max_of(term), max_of(term));
  }
  return size;
}

bool FitProblem::fits_hand(Eigen::Index unknown) const noexcept {
  return mode_ == FitMode::full && (unknown >= shape_unknowns || !size_known_);
}

FitProblem::Hands FitProblem::hands(const Unknowns& at, bool with_moved) const {
  Hands hands{HandSkeleton(side_, size(at)), {}};
  for (Eigen::Index k = hand_unknowns; with_moved && k < habit_unknowns; ++k) {
    if (!fits_hand(k)) continue;
    Unknowns next = at;
    next[k] += hand_step;
    hands.moved.push_back({k, HandSkeleton(side_, size(next))});
  }
  return hands;
}

void FitProblem::find_range_ends(const CountRanges& free_motion) {
  for (const Sensor sensor : sensors_) {
    const std::size_t slot = index_of(sensor);
    if (!free_motion.present.has(sensor) || stiff_.has(sensor)) continue;
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
    if (high_deviation_deg > 0.0 && high <= max_counts_ && high >= most - short_of_poses)
      range_ends_.push_back(
          {slot, high, {from_degrees(high_deg), from_degrees(high_deviation_deg)}});
  }
  height_ += static_cast<Eigen::Index>(range_ends_.size());
}

bool FitProblem::usable(const Touch& touch) const noexcept {
  // What is filled in by rule is no measurement: a loop needs sensors all the way around.
  const SensorMask moving{sensors_.bits & ~stiff_.bits};
  const bool whole = moving.has(Sensor::thumb_roll) && moving.has(Sensor::thumb_abduction) &&
                     moving.has(Sensor::thumb_mcp) && moving.has(Sensor::thumb_ip);
  const auto tip = std::find(fingertips.begin() + 1, fingertips.end(), touch.with);
  if (tip == fingertips.end()) return whole;
  const auto& own = finger_sensors[static_cast<std::size_t>(tip - fingertips.begin()) - 1];
  return whole && moving.has(own[0]) && moving.has(own[1]);
}

double FitProblem::palm_m(const Unknowns& at) noexcept {
  return palm_depth_m + palm_depth_deviation_m * at[palm_unknown];
}

Eigen::Vector3d FitProblem::gap_m(const JointAngles& joints, const Touch& touch, double palm_m,
                                  const HandSkeleton& skeleton) const {
  const HandPose pose = skeleton.pose(joints, Eigen::Isometry3d::Identity());
  const Eigen::Vector3d thumb = pose[Joint::thumb_tip] * skeleton.pad();
  const bool finger =
      std::find(fingertips.begin(), fingertips.end(), touch.with) != fingertips.end();
  if (finger) return thumb - pose[touch.with] * skeleton.pad();
  const auto metacarpal = static_cast<Joint>(index_of(touch.with) - 1);
  return thumb - pose[touch.with].translation() + palm_m * pose[metacarpal].linear().col(1);
}

double FitProblem::gap_m(const Unknowns& at, std::size_t reading) const {
  const auto [begin, touch, end] = rows_[reading];
  if (end == touch) return 0.0;
  return gap_m(joints_of(angles_rad(at, reading, nullptr), sensors_),
               *pose_of(readings_[reading].pose).touch, palm_m(at), hands(at, false).now)
      .norm();
}

void FitProblem::add_touch(std::size_t reading, const Unknowns& at, SensorAngles angles,
                           const Hands& hands, const AngleJacobian& by_unknowns,
                           Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const {
  const Eigen::Index row = rows_[reading].touch;
  const Touch& touch = *pose_of(readings_[reading].pose).touch;
  const double palm = palm_m(at);
  const JointAngles joints = joints_of(angles, sensors_);
  const Eigen::Vector3d off_m = gap_m(joints, touch, palm, hands.now);
  const double weight = (touch_is_set_aside_[reading] ? set_aside_weight : 1.0) /
                        std::hypot(touch.deviation_m, form_deviation_m);
  Eigen::Vector3d slopes;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Robust result = robust(weight * off_m[k]);
    residuals[row + k] = result.residual;
    slopes[k] = result.slope * weight;
  }
  if (jacobian == nullptr) return;
  constexpr double step_rad = 1e-5;
  for (const Sensor sensor : sensors_) {
    const std::size_t slot = index_of(sensor);
    const double angle = angles[slot];
    angles[slot] = angle + step_rad;
    const Eigen::Vector3d above = gap_m(joints_of(angles, sensors_), touch, palm, hands.now);
    angles[slot] = angle - step_rad;
    const Eigen::Vector3d slope =
        (above - gap_m(joints_of(angles, sensors_), touch, palm, hands.now)) / (2.0 * step_rad);
    angles[slot] = angle;
    jacobian->block<3, line_unknowns>(row, 0) +=
        slopes.cwiseProduct(slope) * by_unknowns.row(static_cast<Eigen::Index>(slot));
  }
  Unknowns deeper = at;
  deeper[palm_unknown] += 1.0; // linear: any step will do
  jacobian->block<3, 1>(row, palm_unknown) =
      slopes.cwiseProduct(gap_m(joints, touch, palm_m(deeper), hands.now) - off_m);
  for (const auto& [unknown, skeleton] : hands.moved) {
    jacobian->block<3, 1>(row, unknown) =
        slopes.cwiseProduct(gap_m(joints, touch, palm, skeleton) - off_m) / hand_step;
  }
}

} // namespace nendo::hand
