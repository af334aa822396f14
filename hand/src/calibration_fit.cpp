#include <nendo/hand/calibration_fit.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <nendo/base/units.hpp>

#include "fit_priors.hpp"
#include "fit_problem.hpp"

namespace nendo::hand {
namespace {

// An unknown of which the poses leave more than this part of the default's variance is theirs no
// more: it is fixed at the default.
constexpr double most_left_open = 0.8;
// Deviations stay below 15 degrees; a sensor that is off by twice that on average is dead, or its
// poses were others than those named.
constexpr double contradiction_rad = from_degrees(30);
// No sensor needs five times the default's counts for its joint.
constexpr double least_gain_ratio = 0.2;

using Free = std::vector<Eigen::Index>;

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
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    if (!sensors.has(sensor)) continue;
    const std::string where = pose + ", " + name_of_slot(slot) + ": ";
    if (!reading.held.present.has(sensor))
      return about(where + "no reading; hold the pose again with the whole glove connected");
    const double counts = reading.held.mean_counts[slot];
    if (!(counts >= 0.0 && counts <= scale.most))
      return about(where + "not a count from 0 to " + std::to_string(scale.most) +
                   "; hold the pose again");
    const bool at_end = counts <= 1.0 || counts >= scale.most;
    if (at_end && !scale.whole_range)
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
  if (options.scale.most == 0) return about("a scale without counts: nothing to calibrate");
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

Free first_unknowns(SensorMask sensors, const FitOptions& options) {
  const Calibration start = default_calibration(options.scale);
  Free free;
  const auto add = [&](std::size_t unknown) { free.push_back(static_cast<Eigen::Index>(unknown)); };
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const bool real = start.sensors[slot].gain_rad_per_count != 0.0; // slot 7 has no default
    if (!sensors.has(static_cast<Sensor>(slot)) || !real) continue;
    add(gain_of(slot));
    add(level_of(slot));
  }
  for (std::size_t k = 0; options.mode == FitMode::full && k < couplings.size(); ++k) {
    if (sensors.has(couplings[k].of) && sensors.has(couplings[k].by)) add(mix_of(k));
  }
  return free;
}

/// How many of these are the calibration's; they come first.
Eigen::Index lines_in(const Free& free) {
  return std::count_if(free.begin(), free.end(), [](Eigen::Index unknown) {
    return unknown < static_cast<Eigen::Index>(line_unknowns);
  });
}

template <class Matrix>
Eigen::MatrixXd columns_of(const Matrix& matrix, const Free& free) {
  Eigen::MatrixXd chosen(matrix.rows(), static_cast<Eigen::Index>(free.size()));
  for (std::size_t at = 0; at < free.size(); ++at)
    chosen.col(static_cast<Eigen::Index>(at)) = matrix.col(free[at]);
  return chosen;
}

/// What poses as far apart as these say of the free unknowns, J^T J. How far each is off says
/// nothing of a gain: all deviations are in counts here.
Eigen::MatrixXd information_at(const FitProblem& problem, const Free& free, const Unknowns& at) {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  problem.evaluate(at, residuals, &jacobian);
  problem.hold_weights(residuals, 1.0, jacobian);
  const Eigen::MatrixXd slopes = columns_of(jacobian, free);
  return slopes.transpose() * slopes;
}

/// Levenberg and Marquardt's method over the free unknowns, with deviations in counts by so great a
/// part, which follow from turn to turn. The default pulls with its own weight, 1.
void minimise(const FitProblem& problem, const Free& free, double in_counts, Unknowns& at) {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  double damping = 1e-3;
  for (int turn = 0; turn < 60; ++turn) {
    problem.evaluate(at, residuals, &jacobian);
    problem.hold_weights(residuals, in_counts, jacobian);
    const double cost = residuals.squaredNorm() + at.squaredNorm();
    const Eigen::MatrixXd slopes = columns_of(jacobian, free);
    const Eigen::MatrixXd information = slopes.transpose() * slopes;
    Eigen::VectorXd downhill = -(slopes.transpose() * residuals);
    for (std::size_t n = 0; n < free.size(); ++n)
      downhill[static_cast<Eigen::Index>(n)] -= at[free[n]];
    bool better = false;
    double step_length = 0.0;
    for (; !better && damping < 1e12; damping *= 10.0) {
      Eigen::MatrixXd damped = information;
      damped.diagonal() += damping * information.diagonal();
      damped.diagonal().array() += 1.0;
      const Eigen::VectorXd step = damped.llt().solve(downhill);
      Unknowns next = at;
      for (std::size_t n = 0; n < free.size(); ++n)
        next[free[n]] += step[static_cast<Eigen::Index>(n)];
      problem.evaluate(next, residuals, nullptr);
      problem.weigh_as(at, next, in_counts, residuals);
      // false, too, of what is not a number
      better = residuals.squaredNorm() + next.squaredNorm() <= cost;
      if (!better) continue;
      at = next;
      step_length = step.norm();
      damping *= 0.01; // and once more times 10 by the loop
    }
    damping = std::max(damping, 1e-12);
    if (!better || step_length < 1e-10) break;
  }
}

/// Deviations in counts follow gains that are far off, where poses contradict each other, and lead
/// astray: they begin with a fit in radians, and stay there if they fit much worse than that does.
void minimise_safely(const FitProblem& problem, const Free& free, Unknowns& at) {
  constexpr double much_worse = 2.0;
  Eigen::VectorXd residuals;
  const auto cost_at = [&](const Unknowns& x) {
    problem.evaluate(x, residuals, nullptr);
    return residuals.squaredNorm() + x.squaredNorm();
  };
  minimise(problem, free, 0.0, at);
  Unknowns in_counts = at;
  minimise(problem, free, scatter_in_counts, in_counts);
  if (cost_at(in_counts) <= much_worse * cost_at(at) + 1e-9) at = in_counts;
}

/// The covariance of the free unknowns, the default's word included.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& information) {
  Eigen::MatrixXd with_default = information;
  with_default.diagonal().array() += 1.0;
  return with_default.llt().solve(
      Eigen::MatrixXd::Identity(information.rows(), information.cols()));
}

/// Takes out the unknown that is determined least, if any is not determined; those of which the
/// poses say nothing at all go together.
bool drop_undetermined(Free& free, const Eigen::MatrixXd& information, Unknowns& at) {
  const Eigen::VectorXd open = covariance_of(information).diagonal().head(lines_in(free));
  Eigen::Index worst = 0;
  if (open.size() == 0 || open.maxCoeff(&worst) <= most_left_open) return false;
  Free kept;
  for (std::size_t n = 0; n < free.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    if (row < open.size() && (row == worst || open[row] > 0.999))
      at[free[n]] = 0.0;
    else
      kept.push_back(free[n]);
  }
  free = std::move(kept);
  return true;
}

struct Solution {
  Unknowns at = Unknowns::Zero();
  Free free;
  Eigen::MatrixXd information;
  Eigen::MatrixXd covariance; ///< of those free unknowns that are the calibration's
};

Solution solve(const FitProblem& problem, Free free) {
  Solution solution;
  solution.free = std::move(free);
  do {
    minimise_safely(problem, solution.free, solution.at);
    solution.information = information_at(problem, solution.free, solution.at);
  } while (drop_undetermined(solution.free, solution.information, solution.at));
  const Eigen::Index lines = lines_in(solution.free);
  solution.covariance = covariance_of(solution.information).topLeftCorner(lines, lines);
  return solution;
}

/// Of the calibration, whatever the wearer's own unknowns are.
double condition_of(const Eigen::MatrixXd& covariance) {
  if (covariance.rows() == 0) return 1.0;
  const Eigen::VectorXd open =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance, Eigen::EigenvaluesOnly)
          .eigenvalues();
  // What the poses say is what is beyond the prior's 1; rounding may leave that a little below 0.
  const Eigen::ArrayXd said = (open.array().cwiseMax(1e-15).inverse() - 1.0).cwiseMax(0.0);
  return std::sqrt(said.maxCoeff() / std::max(said.minCoeff(), 1e-12 * said.maxCoeff()));
}

void describe_sensors(CalibrationFit& fit, std::span<const PoseReading> readings,
                      SensorMask sensors, const FitProblem& problem, const Solution& solution) {
  std::array<double, sensor_slots> squares{};
  std::array<std::size_t, sensor_slots> counted{};
  const Free lines(solution.free.begin(), solution.free.begin() + lines_in(solution.free));
  for (std::size_t n = 0; n < readings.size(); ++n) {
    FitProblem::AngleJacobian jacobian;
    const SensorAngles angles = problem.angles_rad(solution.at, n, &jacobian);
    for (const auto& [slot, assumed] : problem.assumptions(n)) {
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

Result<void> check_fitted(const CalibrationFit& fit, SensorMask sensors, CountScale scale) {
  const Calibration start = default_calibration(scale);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors.has(static_cast<Sensor>(slot))) continue;
    const SensorFit& sensor = fit.sensors[slot];
    const double gain = fit.calibration.sensors[slot].gain_rad_per_count;
    if (!std::isfinite(gain) || !std::isfinite(fit.calibration.sensors[slot].offset_counts))
      return about(name_of_slot(slot) + ": no line fits its counts; hold the poses again");
    if (sensor.gain_determined && gain < least_gain_ratio * start.sensors[slot].gain_rad_per_count)
      return about(name_of_slot(slot) +
                   ": its counts fall where the joint bends; hold the poses again as named");
    if (sensor.residual_rad > contradiction_rad)
      return about(name_of_slot(slot) +
                   ": the poses contradict each other; hold them again, or see if it works");
  }
  return {};
}

} // namespace

Result<CalibrationFit> fit_calibration(std::span<const PoseReading> readings, Side side,
                                       SensorMask sensors, const FitOptions& options) {
  if (auto fine = check(readings, sensors, options); !fine) return fine.error();
  const FitProblem problem(readings, side, sensors, options);
  Free free = first_unknowns(sensors, options);
  for (const Eigen::Index unknown : problem.wearers_unknowns())
    free.push_back(unknown);
  const Solution solution = solve(problem, std::move(free));
  CalibrationFit fit;
  fit.calibration = problem.calibration(solution.at);
  fit.condition = condition_of(solution.covariance);
  const auto determined = [&](std::size_t unknown) {
    return std::find(solution.free.begin(), solution.free.end(),
                     static_cast<Eigen::Index>(unknown)) != solution.free.end();
  };
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    fit.sensors[slot].gain_determined = determined(gain_of(slot));
    fit.sensors[slot].offset_determined = determined(level_of(slot));
    const auto sensor = static_cast<Sensor>(slot);
    if (sensors.has(sensor) && !(determined(gain_of(slot)) && determined(level_of(slot))))
      fit.undetermined.add(sensor);
  }
  for (std::size_t k = 0; k < couplings.size(); ++k)
    fit.coupling_determined[k] = determined(mix_of(k));
  describe_sensors(fit, readings, sensors, problem, solution);
  describe_readings(fit, readings, problem, solution);
  if (auto fine = check_fitted(fit, sensors, options.scale); !fine) return fine.error();
  return fit;
}

} // namespace nendo::hand
