#pragma once
// Converts joint angles to the counts of a glove's 8-bit converter on a typical wearer's hand. This
// is the inverse of a calibration: angle = gain (count - offset).

#include <array>
#include <cstdint>
#include <random>

#include <nendo/driver/sample.hpp>

#include "simulated/hand_motion.hpp"

namespace nendo::driver {

struct NominalSensor {
  double offset_counts; ///< the count at angle 0
  double gain_rad;      ///< radians a count
};

/// Returns round numbers in the middle of real gloves' calibrations, and zeros for
/// slots that no glove has.
NENDO_API NominalSensor nominal_sensor(Sensor sensor) noexcept;

class NENDO_API TypicalWearer {
public:
  explicit TypicalWearer(std::uint32_t seed) : random_(seed) {}

  /// Returns counts of 1..255, since 0 ends a record on the wire. Every call draws new converter
  /// noise. Slots that no glove has stay 0.
  std::array<RawCount, sensor_slots> counts(const JointAngles& angles);

private:
  std::mt19937 random_;
  std::normal_distribution<double> noise_counts_{0.0, 0.5};
};

} // namespace nendo::driver
