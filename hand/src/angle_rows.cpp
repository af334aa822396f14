#include "angle_rows.hpp"

#include <cmath>
#include <numbers>

#include "hand_shape.hpp"

namespace nendo::hand {

AngleLimits default_angle_limits() noexcept {
  AngleLimits limits;
  const auto set = [&](auto member, double low_deg, double high_deg) {
    member(limits.low) = degrees(low_deg);
    member(limits.high) = degrees(high_deg);
  };
  set([](JointAngles& a) -> double& { return a.thumb_roll_rad; }, -20, 90);
  set([](JointAngles& a) -> double& { return a.thumb_abduction_rad; }, -10, 70);
  set([](JointAngles& a) -> double& { return a.thumb_mcp_flexion_rad; }, -20, 70);
  set([](JointAngles& a) -> double& { return a.thumb_ip_flexion_rad; }, -20, 90);
  set([](JointAngles& a) -> double& { return a.palm_arch_rad; }, -5, 35);
  set([](JointAngles& a) -> double& { return a.wrist_pitch_rad; }, -75, 85);
  set([](JointAngles& a) -> double& { return a.wrist_yaw_rad; }, -40, 30);
  // Sensors measure gaps of -10 to 40 degrees between neighbours; the middle finger leans by half
  // of that either way, and nobody's little finger by two whole gaps.
  constexpr double abduction_deg[4][2] = {{-10, 40}, {-20, 20}, {-40, 10}, {-50, 20}};
  for (std::size_t f = 0; f < 4; ++f) {
    set([&](JointAngles& a) -> double& { return a.fingers[f].mcp_flexion_rad; }, -30, 100);
    set([&](JointAngles& a) -> double& { return a.fingers[f].mcp_abduction_rad; },
        abduction_deg[f][0], abduction_deg[f][1]);
    set([&](JointAngles& a) -> double& { return a.fingers[f].pip_flexion_rad; }, -10, 115);
    set([&](JointAngles& a) -> double& { return a.fingers[f].dip_flexion_rad; }, -10, 85);
  }
  return limits;
}

AllAngles row_of(const JointAngles& angles) noexcept {
  AllAngles row;
  row.head<4>() << angles.thumb_roll_rad, angles.thumb_abduction_rad, angles.thumb_mcp_flexion_rad,
      angles.thumb_ip_flexion_rad;
  Eigen::Index at = 4;
  for (const FingerAngles& finger : angles.fingers) {
    row.segment<4>(at) << finger.mcp_flexion_rad, finger.mcp_abduction_rad, finger.pip_flexion_rad,
        finger.dip_flexion_rad;
    at += 4;
  }
  row[arch_at] = angles.palm_arch_rad;
  row[pitch_at] = angles.wrist_pitch_rad;
  row[yaw_at] = angles.wrist_yaw_rad;
  return row;
}

JointAngles angles_of(const AllAngles& row) noexcept {
  JointAngles angles;
  angles.thumb_roll_rad = row[0];
  angles.thumb_abduction_rad = row[1];
  angles.thumb_mcp_flexion_rad = row[2];
  angles.thumb_ip_flexion_rad = row[3];
  Eigen::Index at = 4;
  for (FingerAngles& finger : angles.fingers) {
    finger = {row[at], row[at + 1], row[at + 2], row[at + 3]};
    at += 4;
  }
  angles.palm_arch_rad = row[arch_at];
  angles.wrist_pitch_rad = row[pitch_at];
  angles.wrist_yaw_rad = row[yaw_at];
  return angles;
}

Box<angle_count> box_of(const AngleLimits& limits) noexcept {
  const AngleLimits usual = default_angle_limits();
  const Box<angle_count> usual_box{row_of(usual.low), row_of(usual.high)};
  Box<angle_count> box{row_of(limits.low), row_of(limits.high)};
  for (int k = 0; k < angle_count; ++k) {
    constexpr double full_turn = 2.0 * std::numbers::pi;
    // Written so that a NaN is refused.
    if (box.low[k] >= -full_turn && box.low[k] <= box.high[k] && box.high[k] <= full_turn) continue;
    box.low[k] = usual_box.low[k];
    box.high[k] = usual_box.high[k];
  }
  return box;
}

AllAngles clamped(AllAngles row, const Box<angle_count>& box) noexcept {
  for (double& angle : row)
    angle = std::isfinite(angle) ? angle : 0.0;
  return row.cwiseMax(box.low).cwiseMin(box.high);
}

} // namespace nendo::hand
