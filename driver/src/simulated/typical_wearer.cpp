#include "simulated/typical_wearer.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::driver {
namespace {

constexpr NominalSensor nominal_mcp{60, 0.0125};
constexpr NominalSensor nominal_pip{60, 0.0125};
constexpr NominalSensor nominal_dip{50, 0.0125};
constexpr NominalSensor nominal_pair{100, 0.0100};
constexpr NominalSensor nominal_none{0, 0};

constexpr std::array<NominalSensor, sensor_slots> nominal{{
    {90, 0.0105},  // thumb_roll
    {100, 0.0125}, // thumb_mcp
    {85, 0.0125},  // thumb_ip
    {100, 0.0125}, // thumb_abduction
    nominal_mcp,   nominal_pip,
    nominal_dip,   nominal_none, // index
    nominal_mcp,   nominal_pip,
    nominal_dip,   nominal_pair, // middle, and its gap to the index finger
    nominal_mcp,   nominal_pip,
    nominal_dip,   nominal_pair, // ring
    nominal_mcp,   nominal_pip,
    nominal_dip,   nominal_pair, // little
    {80, 0.0100},                // palm_arch
    {128, 0.0125},               // wrist_pitch
    {128, 0.0125},               // wrist_yaw
    nominal_none,
}};

} // namespace

NominalSensor nominal_sensor(Sensor sensor) noexcept {
  return nominal[static_cast<std::size_t>(sensor)];
}

std::array<RawCount, sensor_slots> TypicalWearer::counts(const JointAngles& angles) {
  std::array<RawCount, sensor_slots> raw{};
  for (std::size_t k = 0; k < sensor_slots; ++k) {
    if (!sensors_22.has(static_cast<Sensor>(k))) continue;
    const double exact = nominal[k].offset_counts + angles[k] / nominal[k].gain_rad;
    const double count = std::clamp(std::round(exact + noise_counts_(random_)), 1.0, 255.0);
    raw[k].value = static_cast<std::uint16_t>(count);
  }
  return raw;
}

} // namespace nendo::driver
