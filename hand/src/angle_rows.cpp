#include "angle_rows.hpp"

#include <cmath>
#include <numbers>

#include <nendo/hand/joint_limits.hpp>

namespace nendo::hand {

AngleLimits default_angle_limits() noexcept {
  AngleLimits limits;
  for (std::size_t n = 0; n < angle_count; ++n) {
    limits.low[angle_at(n)] = joint_limits[n].min_rad;
    limits.high[angle_at(n)] = joint_limits[n].max_rad;
  }
  return limits;
}

AllAngles row_of(const JointAngles& angles) noexcept {
  AllAngles row;
  for (std::size_t n = 0; n < angle_count; ++n)
    row[static_cast<Eigen::Index>(n)] = angles[angle_at(n)];
  return row;
}

JointAngles angles_of(const AllAngles& row) noexcept {
  JointAngles angles;
  for (std::size_t n = 0; n < angle_count; ++n)
    angles[angle_at(n)] = row[static_cast<Eigen::Index>(n)];
  return angles;
}

Box<row_size> box_of(const AngleLimits& limits) noexcept {
  const AngleLimits usual = default_angle_limits();
  const Box<row_size> usual_box{row_of(usual.low), row_of(usual.high)};
  Box<row_size> box{row_of(limits.low), row_of(limits.high)};
  for (int k = 0; k < row_size; ++k) {
    constexpr double full_turn = 2.0 * std::numbers::pi;
    // Written so that a NaN is refused.
    if (box.low[k] >= -full_turn && box.low[k] <= box.high[k] && box.high[k] <= full_turn) continue;
    box.low[k] = usual_box.low[k];
    box.high[k] = usual_box.high[k];
  }
  return box;
}

AllAngles clamped(AllAngles row, const Box<row_size>& box) noexcept {
  for (double& angle : row)
    angle = std::isfinite(angle) ? angle : 0.0;
  return row.cwiseMax(box.low).cwiseMin(box.high);
}

} // namespace nendo::hand
