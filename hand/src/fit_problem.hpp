#pragma once
// The least-squares problem of a calibration: unknowns, residuals, their derivatives, and solution.

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <nendo/hand/calibration_fit.hpp>

namespace nendo::hand {

/// The unknowns, in units of their prior's standard deviation and 0 at its mean. The first are the
/// calibration: for each slot the gain's logarithm and the angle at the mean of its counts, then
/// the couplings. The others are the wearer's: how deep the palm's flesh is; the hand's length,
/// breadth and shape; and for each slot the habit, by which the joint differs from every asked
/// angle.
inline constexpr Eigen::Index line_unknowns = 2 * sensor_slots + couplings.size();
inline constexpr Eigen::Index palm_unknown = line_unknowns;
inline constexpr Eigen::Index hand_unknowns = palm_unknown + 1;
inline constexpr Eigen::Index shape_unknowns = hand_unknowns + 2;
inline constexpr Eigen::Index habit_unknowns = shape_unknowns + Eigen::Index{shape_terms};
inline constexpr Eigen::Index unknown_count = habit_unknowns + Eigen::Index{sensor_slots};
constexpr Eigen::Index gain_of(std::size_t slot) noexcept {
  return static_cast<Eigen::Index>(2 * slot);
}
constexpr Eigen::Index level_of(std::size_t slot) noexcept {
  return gain_of(slot) + 1;
}
constexpr Eigen::Index mix_of(std::size_t coupling) noexcept {
  return static_cast<Eigen::Index>(2 * sensor_slots + coupling);
}
constexpr Eigen::Index habit_of(std::size_t slot) noexcept {
  return habit_unknowns + static_cast<Eigen::Index>(slot);
}

using Unknowns = Eigen::Matrix<double, unknown_count, 1>;

class FitProblem {
public:
  FitProblem(std::span<const PoseReading> readings, Side side, SensorMask sensors,
             const FitOptions& options);

  Calibration calibration(const Unknowns& at) const;
  HandSize size(const Unknowns& at) const;

  /// Lets the assumption count no more; `number` is its place among assumptions(reading).
  void set_aside(std::size_t reading, std::size_t number) {
    assumptions_[reading][number].is_set_aside = true;
  }
  void set_aside_touch(std::size_t reading) { touch_is_set_aside_[reading] = true; }
  bool touch_is_set_aside(std::size_t reading) const { return touch_is_set_aside_[reading]; }

  /// Computes all residuals, each divided by its deviation, and unless `jacobian` is null their
  /// derivatives by the unknowns.
  void evaluate(const Unknowns& at, Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const;

  // An angle's deviation can be held constant in radians or in counts. In radians, a deviation in
  // counts is multiplied by the gain; see scatter_in_counts.

  /// Rescales the residuals at `at` as if their deviations, of which `part` is held in counts, were
  /// still those at `before`.
  void weigh_as(const Unknowns& before, const Unknowns& at, double part,
                Eigen::VectorXd& residuals) const;
  /// Changes the jacobian to that of residuals of whose deviations `part` is held in counts.
  void hold_weights(const Eigen::VectorXd& residuals, double part, Eigen::MatrixXd& jacobian) const;

  /// A reading's rows: assumed angles from `begin`, its touch from `touch`; `end` is one past them.
  struct Rows {
    Eigen::Index begin, touch, end;
  };
  const Rows& rows(std::size_t reading) const { return rows_[reading]; }
  struct Assumption {
    std::size_t slot;
    AssumedAngle assumed;
    bool is_set_aside = false;
  };
  const std::vector<Assumption>& assumptions(std::size_t reading) const {
    return assumptions_[reading];
  }
  /// Returns the unknowns that are not of the calibration but are solved with it.
  std::vector<Eigen::Index> wearers_unknowns() const;
  /// Returns the distance between the pads that should touch in this reading; 0 without a touch.
  double gap_m(const Unknowns& at, std::size_t reading) const;

  using AngleJacobian = Eigen::Matrix<double, sensor_slots, line_unknowns, Eigen::RowMajor>;
  /// Returns the angles of one reading, and unless `jacobian` is null their derivatives.
  SensorAngles angles_rad(const Unknowns& at, std::size_t reading, AngleJacobian* jacobian) const;

private:
  bool usable(const Touch& touch) const noexcept;
  static double palm_m(const Unknowns& at) noexcept;
  Eigen::Vector3d gap_m(const JointAngles& joints, const Touch& touch, double palm_m,
                        const HandSkeleton& skeleton) const;
  bool fits_hand(Eigen::Index unknown) const noexcept;
  /// The hand's unknowns, each with a hand in which it alone is a little greater.
  struct Moved {
    Eigen::Index unknown;
    HandSkeleton skeleton;
  };
  struct Hands {
    HandSkeleton now;
    std::vector<Moved> moved; ///< empty unless derivatives are wanted
  };
  Hands hands(const Unknowns& at, bool with_moved) const;
  void add_assumptions(std::size_t reading, const Unknowns& at, const SensorAngles& angles,
                       const AngleJacobian& by_unknowns, Eigen::VectorXd& residuals,
                       Eigen::MatrixXd* jacobian) const;
  void add_touch(std::size_t reading, const Unknowns& at, SensorAngles angles, const Hands& hands,
                 const AngleJacobian& by_unknowns, Eigen::VectorXd& residuals,
                 Eigen::MatrixXd* jacobian) const;
  void find_slips();
  void add_range_ends(const Unknowns& at, Eigen::VectorXd& residuals,
                      Eigen::MatrixXd* jacobian) const;
  void find_range_ends(const CountRanges& free_motion);
  void compare_ends(CountRanges now, const CountRanges& then);
  /// Calls visit(row, gain) for each residual of an angle, with the index of its sensor's gain.
  template <class Visit>
  void for_each_line(Visit&& visit) const;

  struct Line {
    double gain, level; ///< the default's, in radians
    double level_unit;
    double mean_counts;

    double turn_rad(double counts) const noexcept { return gain * (counts - mean_counts); }
    double angle_rad(double counts) const noexcept { return level + turn_rad(counts); }
  };
  Line line(const Unknowns& at, std::size_t slot) const noexcept;

  /// Says that a joint was turned to the end of its range at these counts.
  struct RangeEnd {
    std::size_t slot;
    double counts;
    AssumedAngle end;
  };

  std::span<const PoseReading> readings_;
  FitMode mode_;
  bool full_; ///< not quick
  SensorMask sensors_;
  SensorMask stiff_; ///< used in the flat hand only
  Side side_;
  HandSize start_size_;
  bool size_known_;
  Calibration start_;
  double max_counts_;
  std::array<Line, sensor_slots> lines_{};
  std::vector<std::vector<Assumption>> assumptions_;
  std::vector<Rows> rows_;
  std::vector<bool> touch_is_set_aside_;
  std::vector<RangeEnd> range_ends_;
  Eigen::Index height_ = 0;
};

/// Indices of unknowns that are not fixed; those of the calibration come first.
using FreeUnknowns = std::vector<Eigen::Index>;

struct Solution {
  Unknowns at = Unknowns::Zero();
  FreeUnknowns free;
  Eigen::MatrixXd information;
  Eigen::MatrixXd covariance; ///< the free unknowns of the calibration only
};

Eigen::Index lines_in(const FreeUnknowns& free);

template <class Matrix>
Eigen::MatrixXd columns_of(const Matrix& matrix, const FreeUnknowns& free) {
  Eigen::MatrixXd chosen(matrix.rows(), static_cast<Eigen::Index>(free.size()));
  for (std::size_t at = 0; at < free.size(); ++at)
    chosen.col(static_cast<Eigen::Index>(at)) = matrix.col(free[at]);
  return chosen;
}

/// Finds the likeliest unknowns, and fixes at the default those of the calibration that the poses
/// do not determine. The search begins at `start`.
Solution solve(const FitProblem& problem, FreeUnknowns free, const Unknowns& start);
/// Finds the likeliest values of exactly these unknowns. The others stay.
void refine(const FitProblem& problem, const FreeUnknowns& free, Unknowns& at);

} // namespace nendo::hand
