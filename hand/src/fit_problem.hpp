#pragma once
// The least-squares problem of a calibration: unknowns, residuals and their derivatives.

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <nendo/hand/calibration_fit.hpp>

namespace nendo::hand {

/// Unknowns, in units of their prior's standard deviation and 0 at its mean: of each slot the
/// gain's logarithm and the angle at the mean of its counts, then the couplings. These are the
/// calibration. What follows is the wearer's, and not told: how deep the pads are, how far behind
/// the tips, how deep the palm's flesh, and of each slot how far off the asked angle the joint
/// is by habit, as a part of what wearers are off by.
inline constexpr std::size_t line_unknowns = 2 * sensor_slots + couplings.size();
inline constexpr std::size_t habit_unknowns = line_unknowns + 3;
inline constexpr std::size_t unknown_count = habit_unknowns + sensor_slots;
constexpr std::size_t gain_of(std::size_t slot) noexcept {
  return 2 * slot;
}
constexpr std::size_t level_of(std::size_t slot) noexcept {
  return 2 * slot + 1;
}
constexpr std::size_t mix_of(std::size_t coupling) noexcept {
  return 2 * sensor_slots + coupling;
}
constexpr std::size_t habit_of(std::size_t slot) noexcept {
  return habit_unknowns + slot;
}

using Unknowns = Eigen::Matrix<double, unknown_count, 1>;

class FitProblem {
public:
  FitProblem(std::span<const PoseReading> readings, Side side, SensorMask sensors,
             const FitOptions& options);

  Calibration calibration(const Unknowns& at) const;

  /// All residuals, each over its deviation; `jacobian` is theirs by the unknowns.
  void evaluate(const Unknowns& at, Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const;

  // An angle's deviation may be thought of as one in radians or as one in counts, which is the gain
  // at which it is taken times that; see scatter_in_counts.

  /// Makes residuals at `at` those whose deviations, in counts by so great a part, are of `before`.
  void weigh_as(const Unknowns& before, const Unknowns& at, double part,
                Eigen::VectorXd& residuals) const;
  /// Makes of a jacobian that of residuals whose deviations are in counts by so great a part.
  void hold_weights(const Eigen::VectorXd& residuals, double part, Eigen::MatrixXd& jacobian) const;

  /// Where a reading's residuals stand: first, and one past the last of the assumed angles', and
  /// one past the last of all.
  struct Rows {
    Eigen::Index begin, touch, end;
  };
  const Rows& rows(std::size_t reading) const { return rows_[reading]; }
  /// The slot of an assumed angle's residual, and its deviation.
  struct Assumption {
    std::size_t slot;
    AssumedAngle assumed;
  };
  const std::vector<Assumption>& assumptions(std::size_t reading) const {
    return assumptions_[reading];
  }
  /// Those that are no calibration, but are solved with it.
  std::vector<Eigen::Index> wearers_unknowns() const;
  /// Between the pads that should touch in this reading.
  double gap_m(const Unknowns& at, std::size_t reading) const;

  /// Angles of one reading, and their derivatives by the unknowns.
  using AngleJacobian = Eigen::Matrix<double, sensor_slots, line_unknowns, Eigen::RowMajor>;
  SensorAngles angles_rad(const Unknowns& at, std::size_t reading, AngleJacobian* jacobian) const;

private:
  bool usable(const Touch& touch) const noexcept;
  struct Flesh {
    double pad_depth, pad_behind, palm_depth;
  };
  static Flesh flesh_m(const Unknowns& at) noexcept;
  Eigen::Vector3d gap_m(const SensorAngles& angles, const Touch& touch, const Flesh& flesh_m) const;
  void add_assumptions(std::size_t reading, const Unknowns& at, const SensorAngles& angles,
                       const AngleJacobian& by_unknowns, Eigen::VectorXd& residuals,
                       Eigen::MatrixXd* jacobian) const;
  void add_touch(std::size_t reading, const Unknowns& at, SensorAngles angles,
                 const AngleJacobian& by_unknowns, Eigen::VectorXd& residuals,
                 Eigen::MatrixXd* jacobian) const;
  void add_range_ends(const Unknowns& at, Eigen::VectorXd& residuals,
                      Eigen::MatrixXd* jacobian) const;
  void find_range_ends(const CountRanges& free_motion);
  /// visit(row, gain) of each residual that is of an angle, and of which sensor's gain.
  template <class Visit>
  void for_each_line(Visit&& visit) const;

  struct Line {
    double gain, level; ///< of the default, in radians
    double level_unit;
    double mean_counts;
  };
  Line line(const Unknowns& at, std::size_t slot) const noexcept;

  /// A joint was turned as far as it goes.
  struct RangeEnd {
    std::size_t slot;
    double counts;
    AssumedAngle end;
  };

  std::span<const PoseReading> readings_;
  bool full_;
  SensorMask sensors_;
  HandSkeleton skeleton_;
  Calibration start_;
  double most_counts_;
  std::array<Line, sensor_slots> lines_{};
  std::vector<std::vector<Assumption>> assumptions_;
  std::vector<Rows> rows_;
  std::vector<RangeEnd> range_ends_;
  Eigen::Index height_ = 0;
};

} // namespace nendo::hand
