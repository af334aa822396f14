#include "simulated/typical_wearer.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::driver {
namespace {

constexpr NominalSensor mcp{60, 0.0125};
constexpr NominalSensor pip{60, 0.0125};
constexpr NominalSensor dip{50, 0.0125};
constexpr NominalSensor pair{100, 0.0100};
constexpr NominalSensor none{0, 0};

constexpr std::array<NominalSensor, sensor_slots> nominal{{
    {90, 0.0105},                  // thumb_roll
    {100, 0.0125},                 // thumb_mcp
    {85, 0.0125},                  // thumb_ip
    {100, 0.0125},                 // thumb_abduction
    mcp,           pip, dip, none, // index
    mcp,           pip, dip, pair, // middle, and its gap to the index finger
    mcp,           pip, dip, pair, // ring
    mcp,           pip, dip, pair, // little
    {80, 0.0100},                  // palm_arch
    {128, 0.0125},                 // wrist_pitch
    {128, 0.0125},                 // wrist_yaw
    none,
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
