#include "motions/sensor_angles.hpp"

#include <array>

namespace nendo::motions {

using hand::Finger;

hand::SensorAngles sensor_angles_of(const hand::JointAngles& joints) noexcept {
  hand::SensorAngles sensors{};
  const auto set = [&](Sensor sensor, double angle_rad) {
    sensors[static_cast<std::size_t>(sensor)] = angle_rad;
  };
  set(Sensor::thumb_roll, joints.thumb_roll_rad);
  set(Sensor::thumb_mcp, joints.thumb_mcp_flexion_rad);
  set(Sensor::thumb_ip, joints.thumb_ip_flexion_rad);
  set(Sensor::thumb_abduction, joints.thumb_abduction_rad);
  constexpr std::array<std::array<Sensor, 3>, 4> flexions{
      {{Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip},
       {Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_dip},
       {Sensor::ring_mcp, Sensor::ring_pip, Sensor::ring_dip},
       {Sensor::pinky_mcp, Sensor::pinky_pip, Sensor::pinky_dip}}};
  for (std::size_t k = 0; k < flexions.size(); ++k) {
    set(flexions[k][0], joints.fingers[k].mcp_flexion_rad);
    set(flexions[k][1], joints.fingers[k].pip_flexion_rad);
    set(flexions[k][2], joints.fingers[k].dip_flexion_rad);
  }
  const auto gap = [&](Finger towards_thumb, Finger away) {
    return joints[towards_thumb].mcp_abduction_rad - joints[away].mcp_abduction_rad;
  };
  set(Sensor::index_middle_abduction, gap(Finger::index, Finger::middle));
  set(Sensor::middle_ring_abduction, gap(Finger::middle, Finger::ring));
  set(Sensor::ring_pinky_abduction, gap(Finger::ring, Finger::little));
  set(Sensor::palm_arch, joints.palm_arch_rad);
  set(Sensor::wrist_pitch, joints.wrist_pitch_rad);
  set(Sensor::wrist_yaw, joints.wrist_yaw_rad);
  return sensors;
}

} // namespace nendo::motions
