#include <nendo/hand/calibration_fit.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/units.hpp>
#include <nendo/hand/dense.hpp>

#include "fit_priors.hpp"
#include "fit_problem.hpp"

namespace nendo::hand {
namespace {

// Deviations stay below 15 degrees; a sensor that is off by twice that on average has evidence that
// contradicts the rest. So does a line that is five times as flat as the default.
constexpr double contradiction_rad = from_degrees(30);
constexpr double min_gain_ratio = 0.2;
// Touches that leave pads so far apart were other touches.
constexpr double contradiction_m = 0.02;
constexpr int max_outliers = 16;
// A sensor that turns by less than this part of the default's counts for the angles that were asked
// does not work.
constexpr double min_counts_ratio = 0.15;

Error about(std::string what) {
  return {Errc::bad_input, std::move(what)};
}

std::string name_of_slot(std::size_t slot) {
  return std::string(name_of(static_cast<Sensor>(slot)));
}

Result<void> check_reading(const PoseReading& reading, SensorMask sensors, CountScale scale) {
  if (static_cast<std::size_t>(reading.pose) >= pose_count)
    return about("a reading of no known pose: use those of full_poses()");
  const std::string pose(pose_of(reading.pose).name);
  for (const Sensor sensor : sensors) {
    const std::size_t slot = index_of(sensor);
    const std::string where = pose + ", " + name_of_slot(slot) + ": ";
    if (!reading.held.present.has(sensor))
      return about(where + "no reading; hold the pose again with the whole glove connected");
    const double counts = reading.held.mean_counts[slot];
    if (!(counts >= 0.0 && counts <= scale.max_count))
      return about(where + "not a count from 0 to " + std::to_string(scale.max_count) +
                   "; hold the pose again");
    const bool at_end = counts <= 1.0 || counts >= scale.max_count;
    if (at_end && !scale.self_calibrated)
      return about(where + "at the end of its counts; set the glove's gain and hold it again");
  }
  return {};
}

Result<void> check(std::span<const PoseReading> readings, SensorMask sensors,
                   const FitOptions& options) {
  const HandSize& size = options.size;
  if (!(size.length_m >= 0.1 && size.length_m <= 0.3 && size.breadth_m >= 0.04 &&
        size.breadth_m <= 0.15))
    return about("a hand is 0.1 to 0.3 m long and 0.04 to 0.15 m broad: measure it again");
  if (sensors.bits == 0) return about("a glove without sensors: nothing to calibrate");
  if (options.scale.max_count == 0) return about("a scale without counts: nothing to calibrate");
  for (const PoseId id : quick_poses()) {
    const bool there = std::any_of(readings.begin(), readings.end(),
                                   [&](const PoseReading& r) { return r.pose == id; });
    if (!there)
      return about("the pose " + std::string(pose_of(id).name) + " is missing: hold it, too");
  }
  for (const PoseReading& reading : readings) {
    if (auto fine = check_reading(reading, sensors, options.scale); !fine) return fine.error();
  }
  return {};
}

FreeUnknowns first_unknowns(SensorMask sensors, const FitOptions& options) {
  const Calibration start = default_calibration(options.scale);
  FreeUnknowns free;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const bool real = start.sensors[slot].gain_rad_per_count != 0.0; // slot 7 has no default
    if (!sensors.has(static_cast<Sensor>(slot)) || !real) continue;
    if (options.mode != FitMode::touch_up) free.push_back(gain_of(slot));
    free.push_back(level_of(slot));
  }
  for (std::size_t k = 0; options.mode == FitMode::full && k < couplings.size(); ++k) {
    if (sensors.has(couplings[k].of) && sensors.has(couplings[k].by)) free.push_back(mix_of(k));
  }
  return free;
}

/// The condition of the calibration alone, without the wearer's own unknowns.
double condition_of(const Eigen::MatrixXd& covariance) {
  if (covariance.rows() == 0) return 1.0;
  const Eigen::VectorXd open = eigenvalues_of_symmetric(covariance);
  // What the poses say is what is beyond the prior's 1; rounding may leave that a little below 0.
  const Eigen::ArrayXd said = (open.array().cwiseMax(1e-15).inverse() - 1.0).cwiseMax(0.0);
  return std::sqrt(said.maxCoeff() / std::max(said.minCoeff(), 1e-12 * said.maxCoeff()));
}

void describe_sensors(CalibrationFit& fit, std::span<const PoseReading> readings,
                      SensorMask sensors, const FitProblem& problem, const Solution& solution) {
  std::array<double, sensor_slots> squares{};
  std::array<std::size_t, sensor_slots> counted{};
  const FreeUnknowns lines(solution.free.begin(), solution.free.begin() + lines_in(solution.free));
  for (std::size_t n = 0; n < readings.size(); ++n) {
    FitProblem::AngleJacobian jacobian;
    const SensorAngles angles = problem.angles_rad(solution.at, n, &jacobian);
    for (const auto& [slot, assumed, is_set_aside] : problem.assumptions(n)) {
      if (is_set_aside) continue;
      squares[slot] += std::pow(angles[slot] - assumed.angle_rad, 2);
      ++counted[slot];
    }
    const Eigen::MatrixXd slopes = columns_of(jacobian, lines);
    const Eigen::VectorXd variances =
        (slopes * solution.covariance).cwiseProduct(slopes).rowwise().sum();
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      SensorFit& sensor = fit.sensors[slot];
      if (!sensors.has(static_cast<Sensor>(slot))) continue;
      const double counts = readings[n].held.mean_counts[slot];
      sensor.low_counts = n == 0 ? counts : std::min(sensor.low_counts, counts);
      sensor.high_counts = n == 0 ? counts : std::max(sensor.high_counts, counts);
      sensor.deviation_rad += variances[static_cast<Eigen::Index>(slot)];
    }
  }
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    SensorFit& sensor = fit.sensors[slot];
    sensor.deviation_rad = std::sqrt(sensor.deviation_rad / static_cast<double>(readings.size()));
    if (counted[slot] > 0)
      sensor.residual_rad = std::sqrt(squares[slot] / static_cast<double>(counted[slot]));
  }
}

void describe_readings(CalibrationFit& fit, std::span<const PoseReading> readings,
                       const FitProblem& problem, const Solution& solution) {
  Eigen::VectorXd residuals;
  problem.evaluate(solution.at, residuals, nullptr);
  for (std::size_t n = 0; n < readings.size(); ++n) {
    const auto rows = problem.rows(n);
    const auto begin = rows.begin, end = rows.end;
    ReadingFit& reading = fit.readings.emplace_back();
    if (end > begin)
      reading.misfit = std::sqrt(residuals.segment(begin, end - begin).squaredNorm() /
                                 static_cast<double>(end - begin));
    reading.gap_m = problem.gap_m(solution.at, n);
  }
}

/// A fist bends a finger's first two joints. Where their counts do not follow,
/// the glove is broken, or the poses were others than those named.
Result<void> check_fingers(std::span<const PoseReading> readings, SensorMask sensors,
                           const FitOptions& options) {
  const Calibration start = default_calibration(options.scale);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const bool mcp_or_pip =
        slot >= index_of(Sensor::index_mcp) && slot < index_of(Sensor::palm_arch) && slot % 4 < 2;
    const auto sensor = static_cast<Sensor>(slot);
    if (!mcp_or_pip || !sensors.has(sensor) || options.stiff.has(sensor)) continue;
    std::array<double, 2> counts{}, angles{}, number{};
    for (const PoseReading& reading : readings) {
      const AssumedAngle& assumed = pose_of(reading.pose).assumed[slot];
      if (!assumed.known()) continue;
      const std::size_t bent = assumed.angle_rad > from_degrees(45) ? 1 : 0;
      counts[bent] += reading.held.mean_counts[slot];
      angles[bent] += assumed.angle_rad;
      number[bent] += 1.0;
    }
    const double turned = counts[1] / number[1] - counts[0] / number[0];
    const double asked =
        (angles[1] / number[1] - angles[0] / number[0]) / start.sensors[slot].gain_rad_per_count;
    if (turned < -min_counts_ratio * asked)
      return about(name_of_slot(slot) +
                   ": its counts fall where the joint bends; hold the poses again as named");
    if (!(turned > min_counts_ratio * asked))
      return about(name_of_slot(slot) +
                   ": the poses contradict each other; hold them again, or see if it works");
  }
  return {};
}

/// The assumption that is farthest off, in its deviations, of a sensor whose evidence contradicts
/// itself.
std::optional<std::pair<std::size_t, std::size_t>> worst_assumption(const FitProblem& problem,
                                                                    std::size_t readings,
                                                                    const Solution& solution,
                                                                    const Calibration& start) {
  std::array<double, sensor_slots> squares{}, counted{};
  std::vector<SensorAngles> angles;
  for (std::size_t n = 0; n < readings; ++n) {
    angles.push_back(problem.angles_rad(solution.at, n, nullptr));
    for (const auto& [slot, assumed, is_set_aside] : problem.assumptions(n)) {
      if (is_set_aside) continue;
      squares[slot] += std::pow(angles[n][slot] - assumed.angle_rad, 2);
      counted[slot] += 1.0;
    }
  }
  const Calibration fitted = problem.calibration(solution.at);
  std::optional<std::pair<std::size_t, std::size_t>> worst;
  double farthest = 0.0;
  for (std::size_t n = 0; n < readings; ++n) {
    const auto& assumptions = problem.assumptions(n);
    for (std::size_t k = 0; k < assumptions.size(); ++k) {
      const auto& [slot, assumed, is_set_aside] = assumptions[k];
      const bool contradicts =
          std::sqrt(squares[slot] / std::max(counted[slot], 1.0)) > contradiction_rad ||
          fitted.sensors[slot].gain_rad_per_count <
              min_gain_ratio * start.sensors[slot].gain_rad_per_count;
      const double off = std::abs(angles[n][slot] - assumed.angle_rad) / assumed.deviation_rad;
      if (is_set_aside || !contradicts || off <= farthest) continue;
      farthest = off;
      worst = std::pair(n, k);
    }
  }
  return worst;
}

/// Solves, and sets evidence aside until the rest agrees.
Solution solve_without_contradictions(FitProblem& problem, std::size_t readings,
                                      const FreeUnknowns& free, const Calibration& start,
                                      std::vector<Outlier>& outliers) {
  for (;;) {
    Solution solution = solve(problem, free, Unknowns::Zero());
    if (static_cast<int>(outliers.size()) >= max_outliers) return solution;
    bool changed = false;
    if (const auto worst = worst_assumption(problem, readings, solution, start)) {
      const auto [reading, number] = *worst;
      const std::size_t slot = problem.assumptions(reading)[number].slot;
      outliers.push_back({reading, static_cast<Sensor>(slot)});
      problem.set_aside(reading, number);
      changed = true;
    }
    std::size_t widest = readings;
    double widest_m = contradiction_m;
    for (std::size_t n = 0; n < readings; ++n) {
      const double gap_m = problem.touch_is_set_aside(n) ? 0.0 : problem.gap_m(solution.at, n);
      if (gap_m <= widest_m) continue;
      widest = n;
      widest_m = gap_m;
    }
    if (widest < readings) {
      outliers.push_back({widest, std::nullopt});
      problem.set_aside_touch(widest);
      changed = true;
    }
    if (!changed) return solution;
  }
}

/// No line that is flat to nothing, or not a number, leaves the fit: such a sensor keeps the
/// default's.
void replace_bad_lines(CalibrationFit& fit, SensorMask sensors, const Calibration& start) {
  for (const Sensor sensor : sensors) {
    const std::size_t slot = index_of(sensor);
    const auto [gain, offset] = fit.calibration.sensors[slot];
    const double usual = start.sensors[slot].gain_rad_per_count;
    if (std::isfinite(gain) && std::isfinite(offset) && gain >= min_gain_ratio * usual) continue;
    fit.calibration.sensors[slot] = start.sensors[slot];
    fit.sensors[slot].gain_determined = fit.sensors[slot].offset_determined = false;
    fit.undetermined.add(sensor);
  }
}

/// Compares the flexion gains of a finger, and the thumb's roll and abduction, with the default's,
/// and with how those of all sensors compare, because a glove's electronics are common to them.
void find_fingers_with_limited_range(CalibrationFit& fit, SensorMask sensors,
                                     const Calibration& start) {
  constexpr double suspicious = 0.26; // of a logarithm; without stiff fingers it was 0.2 at most
  std::vector<double> all;
  std::array<double, finger_count> sum{}, counted{};
  for (const Sensor sensor : sensors) {
    const std::size_t slot = index_of(sensor);
    if (!fit.sensors[slot].gain_determined || is_gap(sensor)) continue;
    const double beyond = std::log(fit.calibration.sensors[slot].gain_rad_per_count /
                                   start.sensors[slot].gain_rad_per_count);
    all.push_back(beyond);
    if (slot / 4 >= finger_count) continue;
    sum[slot / 4] += beyond;
    counted[slot / 4] += 1.0;
  }
  if (all.empty()) return;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  for (std::size_t finger = 0; finger < finger_count; ++finger)
    fit.limited_range[finger] =
        counted[finger] >= 2.0 && sum[finger] / counted[finger] - *middle > suspicious;
}

double touch_residual_m(const CalibrationFit& fit) {
  double squares = 0.0, touches = 0.0;
  for (const ReadingFit& reading : fit.readings) {
    squares += reading.gap_m * reading.gap_m;
    touches += reading.gap_m > 0.0 ? 1.0 : 0.0;
  }
  return std::sqrt(squares / std::max(touches, 1.0));
}

constexpr std::size_t folds = 4;
// Between two fits that predict about equally well, chance decides; then the full one has more
// evidence.
constexpr double clearly_better = 0.85;
constexpr std::size_t min_held_out = 3;

/// The joints of a hand that are alike, by slot. Gaps and the thumb's roll and abduction are all
/// one, for couplings tie them together.
enum class Alike : std::size_t { mcp, pip, dip, thumb_flexion, coupled, palm, wrist, none };
constexpr std::size_t groups = static_cast<std::size_t>(Alike::none);

Alike alike_of(std::size_t slot) noexcept {
  switch (static_cast<Sensor>(slot)) {
  case Sensor::thumb_mcp:
  case Sensor::thumb_ip:
    return Alike::thumb_flexion;
  case Sensor::thumb_roll:
  case Sensor::thumb_abduction:
    return Alike::coupled;
  case Sensor::palm_arch:
    return Alike::palm;
  case Sensor::wrist_pitch:
  case Sensor::wrist_yaw:
    return Alike::wrist;
  case Sensor::index_abduction:
  case Sensor::unused:
    return Alike::none;
  default:
    break;
  }
  constexpr std::array of_finger{Alike::mcp, Alike::pip, Alike::dip, Alike::coupled};
  return of_finger[slot % 4];
}

struct Cost {
  double full = 0.0, quick = 0.0;
  std::size_t angles = 0;
};

std::vector<PoseReading> two_of(std::span<const PoseReading> readings) {
  std::vector<PoseReading> two;
  for (const PoseId id : quick_poses())
    two.push_back(*std::find_if(readings.begin(), readings.end(),
                                [&](const PoseReading& reading) { return reading.pose == id; }));
  return two;
}

double angle_rad(const Calibration& calibration, const HeldPose& held, std::size_t slot) {
  const auto own = [&](std::size_t of) {
    const auto [gain, offset] = calibration.sensors[of];
    return held.present.has(static_cast<Sensor>(of)) ? gain * (held.mean_counts[of] - offset) : 0.0;
  };
  double angle = own(slot);
  for (std::size_t k = 0; k < couplings.size(); ++k)
    if (couplings[k].of == static_cast<Sensor>(slot))
      angle += calibration.coupling_gains[k] * own(static_cast<std::size_t>(couplings[k].by));
  return angle;
}

/// Puts the quick fit's lines in place of the full fit's for each group of like joints of which
/// they predict held-out poses better: the full fit is made again without a quarter of the takes,
/// four times, and both predict the angles of these. Flat and fist are never held out, because the
/// quick fit rests on them.
void choose_by_held_out_poses(CalibrationFit& fit, std::span<const PoseReading> readings, Side side,
                              SensorMask sensors, const FitOptions& options,
                              const Solution& solution) {
  const std::vector<PoseReading> two = two_of(readings);
  FitOptions quick_options = options;
  quick_options.mode = FitMode::quick;
  const auto quick = fit_calibration(two, side, sensors, quick_options);
  if (!quick) return;
  std::array<Cost, groups> costs{};
  for (std::size_t fold = 0; fold < folds; ++fold) {
    std::vector<PoseReading> kept = two, held_out;
    std::array<std::size_t, pose_count> takes{};
    for (const PoseReading& reading : readings) {
      const bool is_quick = reading.pose == PoseId::flat || reading.pose == PoseId::fist;
      // Poses that follow each other, and takes of one pose, are alike: they go to different folds,
      // whatever the order of the readings.
      const auto pose = static_cast<std::size_t>(reading.pose);
      const std::size_t into = (pose + takes[pose]++) % folds;
      if (!is_quick) (into == fold ? held_out : kept).push_back(reading);
    }
    const FitProblem problem(kept, side, sensors, options);
    Unknowns at = solution.at;
    refine(problem, solution.free, at);
    const Calibration full = problem.calibration(at);
    for (const PoseReading& reading : held_out) {
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        const AssumedAngle& assumed = pose_of(reading.pose).assumed[slot];
        const Alike group = alike_of(slot);
        const auto sensor = static_cast<Sensor>(slot);
        if (!assumed.known() || group == Alike::none || !sensors.has(sensor) ||
            options.stiff.has(sensor))
          continue;
        const auto cost_of = [&](const Calibration& calibration) {
          const double off = angle_rad(calibration, reading.held, slot) - assumed.angle_rad;
          const double residual = robust(off / assumed.deviation_rad).residual;
          return residual * residual;
        };
        Cost& cost = costs[static_cast<std::size_t>(group)];
        cost.full += cost_of(full);
        cost.quick += cost_of(quick->calibration);
        ++cost.angles;
      }
    }
  }
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const Alike group = alike_of(slot);
    if (group == Alike::none || !sensors.has(static_cast<Sensor>(slot))) continue;
    const Cost& cost = costs[static_cast<std::size_t>(group)];
    if (cost.angles < min_held_out || cost.quick >= clearly_better * cost.full) continue;
    fit.uses_quick_fit.add(static_cast<Sensor>(slot));
    fit.calibration.sensors[slot] = quick->calibration.sensors[slot];
    for (std::size_t k = 0; k < couplings.size(); ++k)
      if (couplings[k].of == static_cast<Sensor>(slot))
        fit.calibration.coupling_gains[k] = quick->calibration.coupling_gains[k];
  }
}

} // namespace

SensorMask sensors_of(Finger finger) noexcept {
  const std::size_t first = 4 * static_cast<std::size_t>(finger);
  SensorMask mask;
  for (std::size_t slot = first; slot < first + 4; ++slot)
    mask.add(static_cast<Sensor>(slot));
  const bool has_gap_behind = finger != Finger::thumb && finger != Finger::little;
  if (has_gap_behind) mask.add(static_cast<Sensor>(first + 7));
  return mask;
}

Result<CalibrationFit> fit_calibration(std::span<const PoseReading> readings, Side side,
                                       SensorMask sensors, const FitOptions& options) {
  if (auto fine = check(readings, sensors, options); !fine) return fine.error();
  if (auto fine = check_fingers(readings, sensors, options); !fine) return fine.error();
  FitProblem problem(readings, side, sensors, options);
  FreeUnknowns free = first_unknowns(sensors, options);
  for (const Eigen::Index unknown : problem.wearers_unknowns())
    free.push_back(unknown);
  const Calibration start = options.start.value_or(default_calibration(options.scale));
  CalibrationFit fit;
  const Solution solution =
      solve_without_contradictions(problem, readings.size(), free, start, fit.outliers);
  fit.calibration = problem.calibration(solution.at);
  fit.size = problem.size(solution.at);
  fit.condition = condition_of(solution.covariance);
  const auto determined = [&](Eigen::Index unknown) {
    return std::find(solution.free.begin(), solution.free.end(), unknown) != solution.free.end();
  };
  const bool gains_are_kept = options.mode == FitMode::touch_up;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    fit.sensors[slot].gain_determined = gains_are_kept || determined(gain_of(slot));
    fit.sensors[slot].offset_determined = gains_are_kept || determined(level_of(slot));
    const auto sensor = static_cast<Sensor>(slot);
    const SensorFit& of = fit.sensors[slot];
    if (sensors.has(sensor) && !(of.gain_determined && of.offset_determined))
      fit.undetermined.add(sensor);
  }
  describe_sensors(fit, readings, sensors, problem, solution);
  describe_readings(fit, readings, problem, solution);
  fit.touch_residual_m = touch_residual_m(fit);
  if (options.mode == FitMode::full && options.hold_out)
    choose_by_held_out_poses(fit, readings, side, sensors, options, solution);
  replace_bad_lines(fit, sensors, start);
  if (options.mode == FitMode::full) find_fingers_with_limited_range(fit, sensors, start);
  return fit;
}

} // namespace nendo::hand
