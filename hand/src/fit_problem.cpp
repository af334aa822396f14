#include "fit_problem.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/base/units.hpp>
#include <nendo/hand/dense.hpp>

#include "fit_priors.hpp"

namespace nendo::hand {
namespace {

double mix_deviation(std::size_t coupling) {
  const Sensor of = couplings[coupling].of;
  return of == Sensor::thumb_roll || of == Sensor::thumb_abduction ? thumb_mix_deviation
                                                                   : gap_mix_deviation;
}

/// The mean angle of wearers where this one is asked for.
AssumedAngle as_it_comes_out(AssumedAngle assumed, std::size_t slot) {
  const bool is_pip =
      slot >= index_of(Sensor::index_pip) && slot % 4 == 1 && slot < index_of(Sensor::palm_arch);
  if (is_pip && assumed.angle_rad == 0.0) assumed.angle_rad = straight_pip_rad;
  return assumed;
}

/// Whether the sensor measures flexion of a finger or of the thumb.
bool is_flexion(std::size_t slot) {
  const RangeEnds& ends = range_ends_of[slot];
  return ends.high_deviation_deg > 0.0 && ends.low_deviation_deg == 0.0;
}

// An unknown of which the poses leave more than this part of the default's variance is fixed at
// the default.
constexpr double max_left_open = 0.8;

/// The information of such poses about the free unknowns, J^T J. All deviations are in counts here,
/// because the poses' errors say nothing about a gain.
Eigen::MatrixXd information_at(const FitProblem& problem, const FreeUnknowns& free,
                               const Unknowns& at) {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  problem.evaluate(at, residuals, &jacobian);
  problem.hold_weights(residuals, 1.0, jacobian);
  const Eigen::MatrixXd slopes = columns_of(jacobian, free);
  return slopes.transpose() * slopes;
}

/// Levenberg and Marquardt's method over the free unknowns, with deviations in counts by so great a
/// part, which follow from turn to turn. The default pulls with its own weight, 1.
void minimise(const FitProblem& problem, const FreeUnknowns& free, double in_counts, Unknowns& at) {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  double damping = 1e-3;
  for (int turn = 0; turn < 60; ++turn) {
    problem.evaluate(at, residuals, &jacobian);
    problem.hold_weights(residuals, in_counts, jacobian);
    const double cost = residuals.squaredNorm() + at.squaredNorm();
    const Eigen::MatrixXd slopes = columns_of(jacobian, free);
    Eigen::MatrixXd information = // of which the lower half is used
        Eigen::MatrixXd::Zero(slopes.cols(), slopes.cols());
    information.selfadjointView<Eigen::Lower>().rankUpdate(slopes.transpose());
    Eigen::VectorXd downhill = -(slopes.transpose() * residuals);
    for (std::size_t n = 0; n < free.size(); ++n)
      downhill[static_cast<Eigen::Index>(n)] -= at[free[n]];
    bool better = false;
    double step_length = 0.0;
    for (; !better && damping < 1e12; damping *= 10.0) {
      Eigen::MatrixXd damped = information;
      damped.diagonal() += damping * information.diagonal();
      damped.diagonal().array() += 1.0;
      Eigen::VectorXd step = downhill;
      solve_positive_definite(damped, step);
      Unknowns next = at;
      for (std::size_t n = 0; n < free.size(); ++n)
        next[free[n]] += step[static_cast<Eigen::Index>(n)];
      problem.evaluate(next, residuals, nullptr);
      problem.weigh_as(at, next, in_counts, residuals);
      // false for NaN
      better = residuals.squaredNorm() + next.squaredNorm() <= cost;
      if (!better) continue;
      at = next;
      step_length = step.norm();
      damping *= 0.01; // and once more times 10 by the loop
    }
    damping = std::max(damping, 1e-12);
    if (!better || step_length < 1e-7) break;
  }
}

/// Deviations in counts follow gains that are far off, where poses contradict each other, and lead
/// astray: they begin with a fit in radians, and stay there if they fit much worse than that does.
void minimise_safely(const FitProblem& problem, const FreeUnknowns& free, Unknowns& at) {
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

/// The covariance of the free unknowns, with the default as prior.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& information) {
  Eigen::MatrixXd with_default = information;
  with_default.diagonal().array() += 1.0;
  return inverse_of_positive_definite(with_default);
}

/// Removes the unknown that is determined least, if any is not determined; those about which the
/// poses say nothing are removed together.
bool drop_undetermined(FreeUnknowns& free, const Eigen::MatrixXd& information, Unknowns& at) {
  const Eigen::VectorXd open = covariance_of(information).diagonal().head(lines_in(free));
  Eigen::Index worst = 0;
  if (open.size() == 0 || open.maxCoeff(&worst) <= max_left_open) return false;
  FreeUnknowns kept;
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

} // namespace

FitProblem::FitProblem(std::span<const PoseReading> readings, Side side, SensorMask sensors,
                       const FitOptions& options)
    : readings_(readings), mode_(options.mode), full_(options.mode != FitMode::quick),
      sensors_(sensors), stiff_(options.stiff), side_(side), start_size_(options.size),
      size_known_(options.size_known),
      start_(options.start.value_or(default_calibration(options.scale))),
      max_counts_(options.scale.max_count), touch_is_set_aside_(readings.size()) {
  for (const Sensor sensor : sensors_) {
    const std::size_t slot = index_of(sensor);
    double mean = 0.0;
    for (const auto& reading : readings_)
      mean += reading.held.mean_counts[slot] / static_cast<double>(readings_.size());
    const auto [gain, offset] = start_.sensors[slot];
    lines_[slot] = {gain, gain * (mean - offset),
                    gain * offset_deviation_of_range * options.scale.max_count, mean};
  }
  for (const auto& reading : readings_) {
    const CalibrationPose& pose = pose_of(reading.pose);
    auto& assumptions = assumptions_.emplace_back();
    for (const Sensor sensor : sensors_) {
      const std::size_t slot = index_of(sensor);
      // Without couplings, a fist says nothing about the gaps between fingers.
      const bool is_flat = reading.pose == PoseId::flat;
      const bool counts = is_flat || (!stiff_.has(sensor) && (full_ || is_flexion(slot)));
      if (pose.assumed[slot].known() && counts)
        assumptions.push_back({slot, as_it_comes_out(pose.assumed[slot], slot)});
    }
    const Eigen::Index touch = height_ + static_cast<Eigen::Index>(assumptions.size());
    const bool touches = full_ && pose.touch && usable(*pose.touch);
    rows_.push_back({height_, touch, touch + (touches ? 3 : 0)});
    height_ = rows_.back().end;
  }
  if (mode_ == FitMode::full) find_range_ends(options.free_motion);
  if (mode_ == FitMode::touch_up) {
    compare_ends(options.free_motion, options.start_ends);
    find_slips();
  }
}

/// A slip moves both ends of a sensor's range by the same. A hand that goes less far, or farther,
/// than it did moves them against each other, and shows the slip the less surely. How far gaps
/// between fingers go depends on how the fingers are bent.
void FitProblem::compare_ends(CountRanges now, const CountRanges& then) {
  for (const Sensor sensor : sensors_) {
    const std::size_t slot = index_of(sensor);
    if (!now.present.has(sensor) || !then.present.has(sensor) || is_gap(sensor)) continue;
    const double moves = now.high_counts[slot] - now.low_counts[slot],
                 moved = then.high_counts[slot] - then.low_counts[slot];
    // Written so that a NaN is no motion.
    if (!(moved > 0.0 && moves >= min_part_of_range * moved && moves <= max_counts_)) continue;
    for (const auto& reading : readings_)
      now.widen(sensor, reading.held.mean_counts[slot]);
    const double low = now.low_counts[slot] - then.low_counts[slot],
                 high = now.high_counts[slot] - then.high_counts[slot];
    const double middle_counts = 0.5 * (then.low_counts[slot] + then.high_counts[slot]),
                 against_rad = 0.5 * lines_[slot].gain * (high - low);
    range_ends_.push_back({slot,
                           middle_counts + 0.5 * (low + high),
                           {lines_[slot].angle_rad(middle_counts),
                            std::hypot(middle_of_ends_deviation_rad, against_rad)}});
  }
  height_ += static_cast<Eigen::Index>(range_ends_.size());
}

/// Poses and ends of ranges say how far each sensor is off, and how surely. The variance beyond
/// that is slip.
void FitProblem::find_slips() {
  struct Said {
    double off = 0.0, weight = 0.0; ///< the weighted sum of offsets, and of weights
    void add(double off_rad, double deviation_rad) {
      weight += 1.0 / (deviation_rad * deviation_rad);
      off += off_rad / (deviation_rad * deviation_rad);
    }
  };
  std::array<Said, sensor_slots> said{};
  for (std::size_t reading = 0; reading < readings_.size(); ++reading) {
    const SensorAngles angles = angles_rad(Unknowns::Zero(), reading, nullptr);
    for (const auto& [slot, assumed, is_set_aside] : assumptions_[reading])
      said[slot].add(angles[slot] - assumed.angle_rad, assumed.deviation_rad);
  }
  for (const auto& [slot, counts, end] : range_ends_)
    said[slot].add(lines_[slot].angle_rad(counts) - end.angle_rad, end.deviation_rad);
  double sum = 0.0, weights = 0.0;
  for (const Said& of_sensor : said) {
    if (of_sensor.weight == 0.0) continue;
    const double off = of_sensor.off / of_sensor.weight;
    const double weight = of_sensor.weight * of_sensor.weight; // of a square
    sum += weight * std::clamp(off * off - 1.0 / of_sensor.weight, -max_slip_rad * max_slip_rad,
                               max_slip_rad * max_slip_rad);
    weights += weight;
  }
  const double slip_rad = std::clamp(std::sqrt(std::max(sum, 0.0) / std::max(weights, 1.0)),
                                     min_slip_rad, max_slip_rad);
  for (Line& line : lines_)
    line.level_unit = slip_rad;
}

std::vector<Eigen::Index> FitProblem::wearers_unknowns() const {
  std::vector<Eigen::Index> chosen;
  const bool touches = std::any_of(rows_.begin(), rows_.end(),
                                   [](const Rows& rows) { return rows.end > rows.touch; });
  for (Eigen::Index k = line_unknowns; k < habit_unknowns && touches; ++k)
    if (k < hand_unknowns || fits_hand(k)) chosen.push_back(k);
  std::array<bool, sensor_slots> bent{};
  for (const auto& of_reading : assumptions_)
    for (const Assumption& assumption : of_reading)
      bent[assumption.slot] = bent[assumption.slot] || (full_ && assumption.assumed.by_feel);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (bent[slot]) chosen.push_back(habit_of(slot));
  return chosen;
}

FitProblem::Line FitProblem::line(const Unknowns& at, std::size_t slot) const noexcept {
  Line line = lines_[slot];
  line.gain *= std::exp(gain_deviation * at[gain_of(slot)]);
  line.level += line.level_unit * at[level_of(slot)];
  return line;
}

Calibration FitProblem::calibration(const Unknowns& at) const {
  Calibration fitted = start_;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const Line now = line(at, slot);
    if (now.gain != 0.0) fitted.sensors[slot] = {now.gain, now.mean_counts - now.level / now.gain};
  }
  for (std::size_t k = 0; k < couplings.size(); ++k)
    fitted.coupling_gains[k] += mix_deviation(k) * at[mix_of(k)];
  return fitted;
}

SensorAngles FitProblem::angles_rad(const Unknowns& at, std::size_t reading,
                                    AngleJacobian* jacobian) const {
  const auto& counts = readings_[reading].held.mean_counts;
  SensorAngles own{};
  if (jacobian != nullptr) jacobian->setZero();
  for (const Sensor sensor : sensors_) {
    const std::size_t slot = index_of(sensor);
    const Line now = line(at, slot);
    own[slot] = now.angle_rad(counts[slot]);
    if (jacobian == nullptr) continue;
    const auto row = static_cast<Eigen::Index>(slot);
    (*jacobian)(row, gain_of(slot)) = gain_deviation * now.turn_rad(counts[slot]);
    (*jacobian)(row, level_of(slot)) = now.level_unit;
  }
  SensorAngles angles = own;
  AngleJacobian mixed;
  if (jacobian != nullptr) mixed = *jacobian;
  for (std::size_t k = 0; k < couplings.size(); ++k) {
    const auto [of, by] = couplings[k];
    if (!sensors_.has(of) || !sensors_.has(by)) continue;
    const Eigen::Index column = mix_of(k);
    const double mix = start_.coupling_gains[k] + mix_deviation(k) * at[column];
    angles[index_of(of)] += mix * own[index_of(by)];
    if (jacobian == nullptr) continue;
    const auto row = static_cast<Eigen::Index>(index_of(of));
    mixed.row(row) += mix * jacobian->row(static_cast<Eigen::Index>(index_of(by)));
    mixed(row, column) += mix_deviation(k) * own[index_of(by)];
  }
  if (jacobian != nullptr) *jacobian = mixed;
  return angles;
}

void FitProblem::add_assumptions(std::size_t reading, const Unknowns& at,
                                 const SensorAngles& angles, const AngleJacobian& by_unknowns,
                                 Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const {
  Eigen::Index row = rows_[reading].begin;
  for (const auto& [slot, assumed, is_set_aside] : assumptions_[reading]) {
    // Two poses cannot show a habit.
    const double habit_rad = full_ && assumed.by_feel ? habit_part * assumed.deviation_rad : 0.0;
    const double deviation_rad =
        std::sqrt(assumed.deviation_rad * assumed.deviation_rad - habit_rad * habit_rad);
    const Eigen::Index habit = habit_of(slot);
    const double meant_rad = assumed.angle_rad + habit_rad * at[habit];
    const double weight = is_set_aside ? set_aside_weight : 1.0;
    const Robust result = robust((angles[slot] - meant_rad) / deviation_rad);
    residuals[row] = weight * result.residual;
    if (jacobian != nullptr) {
      const double slope = weight * result.slope / deviation_rad;
      jacobian->row(row).head<line_unknowns>() =
          slope * by_unknowns.row(static_cast<Eigen::Index>(slot));
      (*jacobian)(row, habit) = -slope * habit_rad;
    }
    ++row;
  }
}

void FitProblem::add_range_ends(const Unknowns& at, Eigen::VectorXd& residuals,
                                Eigen::MatrixXd* jacobian) const {
  Eigen::Index row = height_ - static_cast<Eigen::Index>(range_ends_.size());
  for (const auto& [slot, counts, end] : range_ends_) {
    const Line now = line(at, slot);
    const Robust result = robust((now.angle_rad(counts) - end.angle_rad) / end.deviation_rad);
    residuals[row] = result.residual;
    if (jacobian != nullptr) {
      const double slope = result.slope / end.deviation_rad;
      (*jacobian)(row, gain_of(slot)) = slope * gain_deviation * now.turn_rad(counts);
      (*jacobian)(row, level_of(slot)) = slope * now.level_unit;
    }
    ++row;
  }
}

void FitProblem::evaluate(const Unknowns& at, Eigen::VectorXd& residuals,
                          Eigen::MatrixXd* jacobian) const {
  residuals.resize(height_);
  if (jacobian != nullptr) jacobian->setZero(height_, unknown_count);
  AngleJacobian by_unknowns;
  const Hands hands = this->hands(at, jacobian != nullptr);
  for (std::size_t n = 0; n < readings_.size(); ++n) {
    const SensorAngles angles = angles_rad(at, n, jacobian == nullptr ? nullptr : &by_unknowns);
    add_assumptions(n, at, angles, by_unknowns, residuals, jacobian);
    if (rows_[n].end > rows_[n].touch)
      add_touch(n, at, angles, hands, by_unknowns, residuals, jacobian);
  }
  add_range_ends(at, residuals, jacobian);
}

template <class Visit>
void FitProblem::for_each_line(Visit&& visit) const {
  for (std::size_t n = 0; n < readings_.size(); ++n) {
    Eigen::Index row = rows_[n].begin;
    for (const Assumption& assumption : assumptions_[n])
      visit(row++, gain_of(assumption.slot));
  }
  Eigen::Index row = height_ - static_cast<Eigen::Index>(range_ends_.size());
  for (const RangeEnd& end : range_ends_)
    visit(row++, gain_of(end.slot));
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

Eigen::Index lines_in(const FreeUnknowns& free) {
  return std::count_if(free.begin(), free.end(),
                       [](Eigen::Index unknown) { return unknown < line_unknowns; });
}

Solution solve(const FitProblem& problem, FreeUnknowns free, const Unknowns& start) {
  Solution solution;
  solution.at = start;
  solution.free = std::move(free);
  do {
    minimise_safely(problem, solution.free, solution.at);
    solution.information = information_at(problem, solution.free, solution.at);
  } while (drop_undetermined(solution.free, solution.information, solution.at));
  const Eigen::Index lines = lines_in(solution.free);
  solution.covariance = covariance_of(solution.information).topLeftCorner(lines, lines);
  return solution;
}

void refine(const FitProblem& problem, const FreeUnknowns& free, Unknowns& at) {
  minimise(problem, free, scatter_in_counts, at);
}

} // namespace nendo::hand
