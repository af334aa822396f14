#pragma once
// The least-squares problem of a calibration: unknowns, residuals and their derivatives.

#include <array>
#include <span>

#include <Eigen/Core>

#include <nendo/hand/calibration_fit.hpp>

namespace nendo::hand {

/// Unknowns, in units of the default's standard deviation and 0 at the default: of each slot the
/// gain's logarithm and the angle at the mean of its counts, then the couplings.
inline constexpr std::size_t unknown_count = 2 * sensor_slots + couplings.size();
constexpr std::size_t gain_of(std::size_t slot) noexcept {
  return 2 * slot;
}
constexpr std::size_t level_of(std::size_t slot) noexcept {
  return 2 * slot + 1;
}
constexpr std::size_t mix_of(std::size_t coupling) noexcept {
  return 2 * sensor_slots + coupling;
}

using Unknowns = Eigen::Matrix<double, unknown_count, 1>;

class FitProblem {
public:
  FitProblem(std::span<const PoseReading> readings, Side side, SensorMask sensors,
             const FitOptions& options);

  Calibration calibration(const Unknowns& at) const;

  /// All residuals, each over its deviation; `jacobian` is theirs by the unknowns.
  void evaluate(const Unknowns& at, Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const;

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
  /// Angles of one reading, and their derivatives by the unknowns.
  using AngleJacobian = Eigen::Matrix<double, sensor_slots, unknown_count, Eigen::RowMajor>;
  SensorAngles angles_rad(const Unknowns& at, std::size_t reading, AngleJacobian* jacobian) const;

private:
  bool usable(const Touch& touch) const noexcept;
  Eigen::Vector3d gap_m(const SensorAngles& angles, const Touch& touch) const;

  struct Line {
    double gain, level; ///< of the default, in radians
    double level_unit;
    double mean_counts;
  };
  Line line(const Unknowns& at, std::size_t slot) const noexcept;

  std::span<const PoseReading> readings_;
  SensorMask sensors_;
  HandSkeleton skeleton_;
  Calibration start_;
  std::array<Line, sensor_slots> lines_{};
  std::vector<std::vector<Assumption>> assumptions_;
  std::vector<Rows> rows_;
};

} // namespace nendo::hand
