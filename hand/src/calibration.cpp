#include <nendo/hand/calibration.hpp>

namespace nendo::hand {
namespace {

// A glove's 24 slots, in their order; all zero where no glove has a sensor.
struct TypicalSensor {
  double offset_counts; ///< counts of 255, in a CyberGlove
  double gain_rad;      ///< a count of 255, in a CyberGlove
  double low_deg;       ///< where a self-calibrated scale begins
  double high_deg;      ///< where it ends
};

// Gains of published CyberGlove calibrations lie between 0.010 and 0.016 rad a count, and the raw
// ranges that users report run from about 60 to 200 of 255. A flat hand near the low end and 0.0125
// rad a count cover the range of motion of each flexion joint inside those counts. Wrist sensors
// are centred, because they turn both ways.
// The ranges are the means of the American Academy of Orthopaedic Surgeons where it has one
// (finger MCP 90, PIP 100, DIP 80, thumb MCP 50 to 55 and IP 80, wrist 70 to 80 and 20 to 30), and
// for the others what a spread or cupped hand shows.
constexpr TypicalSensor mcp{60, 0.0125, 0, 90};
constexpr TypicalSensor pip{60, 0.0125, 0, 100};
constexpr TypicalSensor dip{50, 0.0125, 0, 80};
constexpr TypicalSensor pair{100, 0.0100, 0, 25};
constexpr TypicalSensor none{0, 0, 0, 0};
constexpr std::array<TypicalSensor, sensor_slots> typical{{
    {90, 0.0105, 0, 75},  // thumb_roll
    {100, 0.0125, 0, 55}, // thumb_mcp
    {85, 0.0125, 0, 80},  // thumb_ip
    {100, 0.0125, 0, 50}, // thumb_abduction
    mcp,
    pip,
    dip,
    none, // index
    mcp,
    pip,
    dip,
    pair, // middle, and its gap to the index finger
    mcp,
    pip,
    dip,
    pair, // ring
    mcp,
    pip,
    dip,
    pair,                   // little
    {80, 0.0100, 0, 25},    // palm_arch
    {128, 0.0125, -70, 80}, // wrist_pitch
    {128, 0.0125, -30, 20}, // wrist_yaw
    none,
}};

SensorCalibration spread_over(const TypicalSensor& sensor, double most) noexcept {
  const double range_deg = sensor.high_deg - sensor.low_deg;
  if (range_deg == 0.0) return {};
  return {from_degrees(range_deg) / most, -sensor.low_deg / range_deg * most};
}

SensorCalibration scaled(const TypicalSensor& sensor, double most) noexcept {
  const double scale = most / 255.0;
  return {sensor.gain_rad / scale, sensor.offset_counts * scale};
}

} // namespace

SensorAngles Calibration::angles_rad(const GloveSample& sample) const noexcept {
  SensorAngles lines{};
  for (const Sensor sensor : sample.present)
    lines[index_of(sensor)] = (*this)[sensor].angle_rad(sample[sensor]);
  SensorAngles angles = lines;
  for (std::size_t k = 0; k < couplings.size(); ++k) {
    const auto [of, by] = couplings[k];
    if (sample.present.has(of)) angles[index_of(of)] += coupling_gains[k] * lines[index_of(by)];
  }
  return angles;
}

Calibration default_calibration(CountScale scale) noexcept {
  Calibration calibration;
  if (scale.max_count == 0) return calibration;
  const double most = scale.max_count;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    calibration.sensors[slot] =
        scale.self_calibrated ? spread_over(typical[slot], most) : scaled(typical[slot], most);
  }
  return calibration;
}

} // namespace nendo::hand
