#include "bench/calibration_judge.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include <nendo/base/units.hpp>
#include <nendo/hand/angle_sources.hpp>
#include <nendo/hand/calibration_fit.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/pinch_closing.hpp>
#include <nendo/hand/range_capture.hpp>
#include <nendo/hand/skeleton.hpp>

#include "bench/percentiles.hpp"
#include "bench/stranger_floor.hpp"

namespace nendo::bench {
namespace {

using hand::JointAngles;

GloveSample judged_sample(const CountRow& counts, const JudgedWearer& wearer) {
  GloveSample sample;
  sample.side = wearer.side;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (wearer.sensors.has(static_cast<Sensor>(slot)))
      sample.set(static_cast<Sensor>(slot), RawCount{counts[slot]});
  return sample;
}

hand::CountRanges ranges_of(const JudgedSession& session, const JudgedWearer& wearer) {
  hand::RangeCapture capture;
  for (const CountRow& row : session.free_motion)
    capture.push(judged_sample(row, wearer));
  return capture.seen();
}

/// What a calibration keeps: the ends of the free motion, or of the poses where these went farther.
hand::CountRanges ends_reached(const JudgedSession& session, const JudgedWearer& wearer) {
  hand::CountRanges ends = ranges_of(session, wearer);
  for (const hand::PoseReading& take : session.takes)
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      if (ends.present.has(static_cast<Sensor>(slot)))
        ends.widen(static_cast<Sensor>(slot), take.held.mean_counts[slot]);
  return ends;
}

/// The group of an angle; nullopt of the middle finger's abduction and the palm's arch.
std::optional<std::size_t> group_of(std::size_t angle) {
  if (angle == 0) return 4;
  if (angle == 1) return 5;
  if (angle < 4) return 6;
  if (angle == hand::index_of(hand::Angle::middle_mcp_abduction)) return std::nullopt;
  if (angle == hand::index_of(hand::Angle::palm_arch)) return std::nullopt;
  if (angle > hand::index_of(hand::Angle::palm_arch)) return 7;
  constexpr std::array<std::size_t, 4> of_finger{0, 3, 1, 2};
  return of_finger[angle % 4];
}

using GroupErrors = std::array<std::vector<float>, judged_groups.size()>;

/// How far apart these pads, thumb's to little finger's, are in this pose.
double pads_apart_mm(const hand::HandPose& pose, const JudgedWearer::Pads& pads, int touching) {
  const auto pad = [&](std::size_t digit) -> Eigen::Vector3d {
    const auto [depth, behind] = pads[digit];
    return pose[hand::fingertips[digit]] * Eigen::Vector3d(0.0, -depth, behind);
  };
  return 1e3 * (pad(0) - pad(static_cast<std::size_t>(touching))).norm();
}

/// What is made of a moment.
struct Estimate {
  JointAngles angles;
  double apart_mm, drawn_apart_mm; ///< the pads that touch
};

template <class EstimateAt>
GroupErrors errors_of(const JudgedWearer& wearer, const JudgedSession& session,
                      EstimateAt&& estimate_at) {
  GroupErrors errors;
  const hand::AngleSources sources = hand::angle_sources(wearer.sensors);
  for (const JudgedMoment& moment : session.motion) {
    const Estimate estimate = estimate_at(moment);
    for (std::size_t n = 0; n < hand::angle_count; ++n) {
      const auto group = group_of(n);
      if (!group || sources[n] == hand::AngleSource::zero) continue;
      const double error = to_degrees(estimate.angles[hand::angle_at(n)]) - moment.angles_deg[n];
      errors[*group].push_back(static_cast<float>(std::abs(error)));
    }
    if (moment.touching == 0) continue;
    errors[judged_groups.size() - 2].push_back(static_cast<float>(estimate.apart_mm));
    errors.back().push_back(static_cast<float>(estimate.drawn_apart_mm));
  }
  return errors;
}

GroupErrors errors_of(const JudgedWearer& wearer, const JudgedSession& session,
                      const hand::Calibration& calibration, const hand::HandSkeleton& skeleton,
                      bool closes_pinches = false) {
  return errors_of(wearer, session, [&](const JudgedMoment& moment) {
    JointAngles angles = hand::joint_angles(judged_sample(moment.counts, wearer), calibration);
    if (closes_pinches) angles = hand::close_pinches(angles, skeleton, wearer.sensors);
    if (moment.touching == 0) return Estimate{angles, 0.0, 0.0};
    const auto pose = skeleton.pose(angles, Eigen::Isometry3d::Identity());
    JudgedWearer::Pads drawn;
    drawn.fill({-skeleton.pad().y(), skeleton.pad().z()});
    return Estimate{angles, pads_apart_mm(pose, wearer.pads, moment.touching),
                    pads_apart_mm(pose, drawn, moment.touching)};
  });
}

/// The angles of joints whose sensors' angles are known: lines that read them, in place of counts.
JointAngles joints_at(const hand::SensorAngles& angles_rad, const JudgedWearer& wearer) {
  hand::Calibration passing;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    passing.sensors[slot] = {1.0, -angles_rad[slot]};
  return hand::joint_angles(judged_sample({}, wearer), passing);
}

GroupErrors errors_of_floor(const JudgedWearer& wearer, const StrangerHand* hand) {
  StrangerFloor floor(wearer, hand);
  return errors_of(wearer, wearer.fresh, [&](const JudgedMoment& moment) {
    hand::SensorAngles angles = floor.angles_rad(moment.counts);
    const JointAngles joints = joints_at(angles, wearer);
    for (std::size_t f = 0; f < joints.fingers.size(); ++f)
      angles[4 * f + 6] = joints.fingers[f].dip_flexion_rad; // by rule, where there is no sensor
    if (moment.touching == 0) return Estimate{joints, 0.0, 0.0};
    const double apart_mm = 1e3 * floor.pads_apart_m(angles, moment.touching);
    return Estimate{joints, apart_mm, apart_mm};
  });
}

/// What each sensor's line would read of the truth: gaps between fingers, not directions.
double true_slot_rad(const JudgedMoment& moment, std::size_t slot) {
  const auto at = [&](hand::Angle angle) {
    return from_degrees(moment.angles_deg[hand::index_of(angle)]);
  };
  switch (static_cast<Sensor>(slot)) {
  case Sensor::thumb_roll:
    return at(hand::Angle::thumb_roll);
  case Sensor::thumb_mcp:
    return at(hand::Angle::thumb_mcp_flexion);
  case Sensor::thumb_ip:
    return at(hand::Angle::thumb_ip_flexion);
  case Sensor::thumb_abduction:
    return at(hand::Angle::thumb_abduction);
  case Sensor::index_middle_abduction:
    return at(hand::Angle::index_mcp_abduction);
  case Sensor::middle_ring_abduction:
    return -at(hand::Angle::ring_mcp_abduction);
  case Sensor::ring_little_abduction:
    return at(hand::Angle::ring_mcp_abduction) - at(hand::Angle::little_mcp_abduction);
  case Sensor::palm_arch:
    return at(hand::Angle::palm_arch);
  case Sensor::wrist_pitch:
    return at(hand::Angle::wrist_pitch);
  case Sensor::wrist_yaw:
    return at(hand::Angle::wrist_yaw);
  default:
    break;
  }
  constexpr std::array<std::size_t, 3> of_finger{0, 2, 3}; // MCP, PIP, DIP
  const std::size_t first = hand::index_of(hand::Angle::index_mcp_flexion);
  return from_degrees(moment.angles_deg[first + 4 * (slot / 4 - 1) + of_finger[slot % 4]]);
}

/// The least-squares weights of these slots' counts, and of 1 at the end, for the true angle.
Eigen::VectorXd weights_for(std::size_t angle_slot, const std::vector<std::size_t>& of,
                            const JudgedWearer& wearer) {
  const auto width = static_cast<Eigen::Index>(of.size() + 1);
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(width, width);
  Eigen::VectorXd side = Eigen::VectorXd::Zero(width), row = Eigen::VectorXd::Ones(width);
  for (const JudgedMoment& moment : wearer.fresh.motion) {
    for (std::size_t k = 0; k < of.size(); ++k)
      row[static_cast<Eigen::Index>(k)] = moment.counts[of[k]];
    square += row * row.transpose();
    side += row * true_slot_rad(moment, angle_slot);
  }
  return square.ldlt().solve(side);
}

/// Thumb roll and abduction, which read each other, are two sums of both sensors' counts.
void set_best_thumb(hand::Calibration& best, const JudgedWearer& wearer) {
  const auto roll_slot = static_cast<std::size_t>(Sensor::thumb_roll);
  const auto abduction_slot = static_cast<std::size_t>(Sensor::thumb_abduction);
  const Eigen::VectorXd roll = weights_for(roll_slot, {roll_slot, abduction_slot}, wearer);
  const Eigen::VectorXd abduction =
      weights_for(abduction_slot, {roll_slot, abduction_slot}, wearer);
  const double mixed_roll = roll[1] / abduction[1], mixed_abduction = abduction[0] / roll[0];
  const double level = (roll[2] - mixed_roll * abduction[2]) / (1.0 - mixed_roll * mixed_abduction);
  best.sensors[roll_slot] = {roll[0], -level / roll[0]};
  best.sensors[abduction_slot] = {abduction[1],
                                  -(abduction[2] - mixed_abduction * level) / abduction[1]};
  best.coupling_gains[0] = mixed_roll;
  best.coupling_gains[1] = mixed_abduction;
}

/// The lines and couplings that fit the motion itself best, by least squares of angles.
hand::Calibration best_lines(const JudgedWearer& wearer) {
  hand::Calibration best = hand::default_calibration();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!wearer.sensors.has(static_cast<Sensor>(slot))) continue;
    std::vector<std::size_t> of{slot}, mixed;
    for (std::size_t k = 2; k < hand::couplings.size(); ++k) {
      if (hand::couplings[k].of != static_cast<Sensor>(slot)) continue;
      of.push_back(static_cast<std::size_t>(hand::couplings[k].by));
      mixed.push_back(k);
    }
    const Eigen::VectorXd weights = weights_for(slot, of, wearer);
    double level = weights[weights.size() - 1];
    for (std::size_t k = 0; k < mixed.size(); ++k) {
      const Eigen::VectorXd line = weights_for(of[k + 1], {of[k + 1]}, wearer);
      best.coupling_gains[mixed[k]] = weights[static_cast<Eigen::Index>(k + 1)] / line[0];
      level -= best.coupling_gains[mixed[k]] * line[1];
    }
    best.sensors[slot] = {weights[0], -level / weights[0]};
  }
  set_best_thumb(best, wearer);
  return best;
}

} // namespace

void judge(const JudgedWearer& wearer, Verdict& verdict, const StrangerHand* hand) {
  ++verdict.wearers;
  std::vector<hand::PoseReading> two;
  for (const hand::PoseId id : hand::quick_poses()) {
    const auto& takes = wearer.fresh.takes;
    const auto found =
        std::find_if(takes.begin(), takes.end(), [&](const auto& take) { return take.pose == id; });
    if (found != takes.end()) two.push_back(*found);
  }
  hand::FitOptions full_options, quick_options;
  full_options.free_motion = ranges_of(wearer.fresh, wearer);
  quick_options.mode = hand::FitMode::quick;
  const auto begin = std::chrono::steady_clock::now();
  const auto full =
      hand::fit_calibration(wearer.fresh.takes, wearer.side, wearer.sensors, full_options);
  verdict.fit_ms.push_back(1e3 * to_seconds(std::chrono::steady_clock::now() - begin));
  const auto quick = hand::fit_calibration(two, wearer.side, wearer.sensors, quick_options);
  if (!full || !quick) {
    verdict.refused.push_back(wearer.name + ": " +
                              (full ? quick.error().message : full.error().message));
    return;
  }
  const hand::HandSkeleton own(wearer.side, full->size), average(wearer.side);
  std::array<GroupErrors, judged_names.size()> errors{
      errors_of(wearer, wearer.fresh, full->calibration, own),
      errors_of(wearer, wearer.fresh, full->calibration, own, true),
      errors_of(wearer, wearer.fresh, quick->calibration, average),
      errors_of(wearer, wearer.fresh, best_lines(wearer), own),
      errors_of(wearer, wearer.again, full->calibration, own),
      {},
      {},
      {}};
  auto& of_floor = errors[static_cast<std::size_t>(Judged::floor)];
  if (hand != nullptr) {
    of_floor = errors_of_floor(wearer, hand);
    errors[static_cast<std::size_t>(Judged::no_hand)] = errors_of_floor(wearer, nullptr);
  }
  if (!wearer.again.takes.empty()) {
    hand::FitOptions again;
    again.mode = hand::FitMode::touch_up;
    again.size = full->size;
    again.start = full->calibration;
    again.start_ends = ends_reached(wearer.fresh, wearer);
    again.free_motion = ranges_of(wearer.again, wearer);
    const auto touched_up =
        hand::fit_calibration(wearer.again.takes, wearer.side, wearer.sensors, again);
    if (!touched_up) {
      verdict.refused.push_back(wearer.name + ", touch-up: " + touched_up.error().message);
      return;
    }
    errors[static_cast<std::size_t>(Judged::touched_up)] =
        errors_of(wearer, wearer.again, touched_up->calibration, own);
  }
  for (std::size_t group = 0; group < judged_groups.size(); ++group) {
    constexpr double tolerance = 0.3;
    const double two_pose =
        percentile(errors[static_cast<std::size_t>(Judged::two_pose)][group], 0.95) + tolerance;
    if (percentile(errors[0][group], 0.95) > two_pose) ++verdict.worse[group];
    if (percentile(of_floor[group], 0.95) > two_pose) ++verdict.floor_worse[group];
    for (std::size_t method = 0; method < errors.size(); ++method) {
      auto& all = verdict.errors[method][group];
      all.insert(all.end(), errors[method][group].begin(), errors[method][group].end());
    }
  }
}

} // namespace nendo::bench
