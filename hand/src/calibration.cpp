#include <nendo/hand/calibration.hpp>

namespace nendo::hand {

// Gains of published CyberGlove calibrations lie between 0.010 and 0.016 rad a count, and the raw
// ranges that users report run from about 60 to 200 of 255. A flat hand near the low end and 0.0125
// rad a count cover the range of motion of each flexion joint inside those counts. Wrist sensors
// are centred, because they turn both ways.
Calibration default_calibration() noexcept {
  Calibration calibration;
  const auto set = [&](Sensor sensor, double offset_counts, double gain_rad_per_count) {
    calibration.sensors[static_cast<std::size_t>(sensor)] = {gain_rad_per_count, offset_counts};
  };
  set(Sensor::thumb_roll, 90, 0.0105);
  set(Sensor::thumb_mcp, 100, 0.0125);
  set(Sensor::thumb_ip, 85, 0.0125);
  set(Sensor::thumb_abduction, 100, 0.0125);
  for (const auto mcp :
       {Sensor::index_mcp, Sensor::middle_mcp, Sensor::ring_mcp, Sensor::pinky_mcp}) {
    set(mcp, 60, 0.0125);
  }
  for (const auto pip :
       {Sensor::index_pip, Sensor::middle_pip, Sensor::ring_pip, Sensor::pinky_pip}) {
    set(pip, 60, 0.0125);
  }
  for (const auto dip :
       {Sensor::index_dip, Sensor::middle_dip, Sensor::ring_dip, Sensor::pinky_dip}) {
    set(dip, 50, 0.0125);
  }
  for (const auto pair : {Sensor::index_middle_abduction, Sensor::middle_ring_abduction,
                          Sensor::ring_pinky_abduction}) {
    set(pair, 100, 0.0100);
  }
  set(Sensor::palm_arch, 80, 0.0100);
  set(Sensor::wrist_pitch, 128, 0.0125);
  set(Sensor::wrist_yaw, 128, 0.0125);
  return calibration;
}

} // namespace nendo::hand
